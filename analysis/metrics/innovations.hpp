// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/verdict/summed_error.hpp"
#include "analysis/verdict/verdict.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Largest lag in scans at which innovations are compared; at most a quarter of the scans.
inline constexpr std::size_t kInnovationLags = 20;

/// Test of the normalised innovations squared (NIS), which needs no truth. A consistent filter has
/// 1 for each degree of freedom, and its innovations are white: independent from scan to scan.
struct Innovations {
  std::vector<double> average;   ///< {scan} NIS over degrees of freedom, over runs; NaN: none
  std::vector<Interval> bounds;  ///< {scan} of the average (chi-square)
  double share_inside = 0.0;     ///< of scans with a degree of freedom
  Verdict verdict;               ///< on size, stretches and scans, if the innovations are white
  std::vector<double> autocorrelation;  ///< {lag - 1} of the NIS, over all runs; NaN: not tested
  /// {lag - 1} bound that white innovations exceed at no lag with the probability of the level.
  std::vector<double> white_bound;
  std::size_t worst_lag = 0;  ///< with the largest ratio of the two; 0: no lag is tested

  bool is_white() const;  ///< whether no lag exceeds its bound; true if none is tested
};

/// "white, consistent", "not white, optimistic", ...
std::string whiteness_in_words(const Innovations& found);

/// Adds up the NIS over runs.
class InnovationSums {
 public:
  explicit InnovationSums(std::size_t scans);

  /// One run, {scan}.
  void add(std::span<const double> nis, std::span<const std::uint32_t> dof);
  bool empty() const { return runs_ == 0; }
  /// `times` [s] of the scans; `level` of the whiteness and of bounds, `within` the margin.
  Innovations result(std::span<const double> times, double level, double within) const;
  static constexpr auto parts() {
    using Sums = InnovationSums;
    return std::tuple(added(&Sums::nis_, &Sums::runs_, &Sums::products_));
  }

 private:
  SummedError nis_;         ///< {scan}
  std::uint64_t runs_ = 0;  ///< with an innovation
  /// Sums over pairs of scans that both have innovations, over all runs.
  struct Products {
    double n = 0.0;        ///< pairs
    double both = 0.0;     ///< sum of all members, two of each pair
    double product = 0.0;  ///< sum of the products
    double mean_product(double mean) const { return product / n - mean * both / n + mean * mean; }
    static constexpr auto parts() {
      return std::tuple(added(&Products::n, &Products::both, &Products::product));
    }
  };
  std::vector<Products> products_;  ///< {lag} from 0
  /// {scan} of the run at hand, the last one first: deviations, and 1 where there is one.
  std::vector<double> deviations_, is_there_;
};

}  // namespace montecarta::analysis
