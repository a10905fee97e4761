// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/verdict/summed_error.hpp"
#include "analysis/verdict/verdict.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Largest lag in scans at which innovations are compared; at most a quarter of the scans.
inline constexpr std::size_t kInnovationLags = 20;

/// Fewest runs by whose means the size of innovations is judged that are not white.
inline constexpr std::size_t kFewestRunsOfSize = 20;

enum class Whiteness : std::uint8_t {
  untested,  ///< too few scans for any lag
  white,     ///< no lag exceeds its bound
  not_white
};

/// The normalised innovation squared (NIS) that is farthest out for its degrees of freedom, and
/// the findings without it.
struct LargestInnovation {
  double nis = kNaN;
  double dof = kNaN;
  std::uint64_t run = 0;
  double time = kNaN;  ///< [s]
  double ratio_without = kNaN;
  Whiteness whiteness_without = Whiteness::untested;
  Answer answer_without = Answer::untested;
};

/// Test of the NIS, which needs no truth. A consistent filter has 1 for each degree of freedom, and
/// its innovations are white: independent from scan to scan.
struct Innovations {
  std::vector<double> average;   ///< {scan} NIS over degrees of freedom, over runs; NaN: none
  std::vector<Interval> bounds;  ///< {scan} of the average (chi-square)
  double share_inside = 0.0;     ///< of scans with a degree of freedom
  double ratio = kNaN;           ///< NIS over degrees of freedom: of the verdict if it judges the
                                 ///< size, else of all runs and scans together
  /// On size, stretches and scans if the innovations are white. If not, on the size by the means of
  /// runs; untested if these are fewer than kFewestRunsOfSize.
  Verdict verdict;
  std::vector<double> autocorrelation;  ///< {lag - 1} of the NIS, over all runs; NaN: not tested
  /// {lag - 1} bound that white innovations exceed at no lag with the probability of the level.
  std::vector<double> white_bound;
  std::size_t worst_lag = 0;  ///< with the largest ratio of the two; 0: no lag is tested
  LargestInnovation largest;

  Whiteness whiteness() const;
  /// Whether the innovations have another whiteness without the largest one, or their size is shown
  /// to be off only with it or only without it.
  bool are_decided_by_largest() const;
};

/// "white, consistent", "not white, size optimistic", "not white, size not judged", ...
std::string whiteness_in_words(Whiteness whiteness, Answer answer);

std::string whiteness_in_words(const Innovations& found);

/// The run with the largest innovation.
struct LargestRun {
  double deviate = 0.0;  ///< of that innovation: standard normal if the filter is consistent
  std::uint64_t run = 0;
  std::uint64_t scan = 0;
  double time = 0.0;  ///< [s] of the scan
  std::vector<double> nis;
  std::vector<std::uint32_t> dof;
  static constexpr auto members() {
    return std::tuple(&LargestRun::deviate, &LargestRun::run, &LargestRun::scan, &LargestRun::time,
                      &LargestRun::nis, &LargestRun::dof);
  }
};

/// Adds up the NIS over runs.
class InnovationSums {
 public:
  explicit InnovationSums(std::size_t scans) : others_(scans) {}

  /// The innovations of the run of this number: {scan} each, `times` [s].
  void add(std::uint64_t run, std::span<const double> times, std::span<const double> nis,
           std::span<const std::uint32_t> dof);
  bool empty() const { return !largest_; }
  /// There must be an innovation. `times` [s] of the scans; `level` of the whiteness and of bounds,
  /// `within` the margin.
  Innovations result(std::span<const double> times, double level, double within) const;
  static constexpr auto parts() {
    using Sums = InnovationSums;
    return std::tuple(Part{[](Sums& sums, Sums& next) { sums.merge(next); },
                           std::tuple(&Sums::others_, &Sums::largest_)});
  }

 private:
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
  /// Sums over whole runs.
  struct Totals {
    explicit Totals(std::size_t scans);
    void add(std::span<const double> nis, std::span<const std::uint32_t> dof);
    Innovations result(std::span<const double> times, double level, double within) const;
    static constexpr auto parts() { return std::tuple(added(&Totals::nis_, &Totals::products_)); }

   private:
    /// Runs with an innovation.
    std::uint64_t runs() const { return nis_.ratios().n; }
    void add_products(std::span<const double> nis, std::span<const std::uint32_t> dof);
    void find_correlations(double level, Innovations& result) const;
    void judge_size(std::span<const double> times, double level, double within,
                    Innovations& result) const;

    SummedError nis_;                 ///< {scan}
    std::vector<Products> products_;  ///< {lag} from 0
    /// {scan} of the run at hand, the last one first: deviations, and 1 where there is one.
    std::vector<double> deviations_, is_there_;
  };
  void merge(InnovationSums& next);

  Totals others_;                      ///< of all runs but that one
  std::optional<LargestRun> largest_;  ///< which is added with its innovation and without it
};

}  // namespace montecarta::analysis
