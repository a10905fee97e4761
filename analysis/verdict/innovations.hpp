// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/verdict/gate_scale.hpp"
#include "analysis/verdict/summed_error.hpp"
#include "analysis/verdict/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Largest lag at which innovations are correlated, counted in innovations; at most a quarter of
/// those of a run.
inline constexpr std::size_t kInnovationLags = 20;

/// Fewest runs whose means judge the size of innovations that are not white.
inline constexpr std::size_t kFewestRunsOfSize = 20;

enum class Whiteness : std::uint8_t {
  untested,  ///< there are too few scans for any lag
  white,     ///< the autocorrelation exceeds its bound at no lag
  not_white
};

/// The normalised innovation squared (NIS) that is most improbable for its degrees of freedom, and
/// the findings without it.
struct LargestInnovation {
  double nis = kNaN;
  double dof = kNaN;
  std::uint64_t run = 0;
  double time = kNaN;   ///< [s] time of the scan
  double origin = 0.0;  ///< [s] time that readers count from: origin_of() all scans
  double ratio_without = kNaN;
  Whiteness whiteness_without = Whiteness::untested;
  Answer answer_without = Answer::untested;
};

/// The correlation of a component of the innovations with itself, each in units of its deviation,
/// at the lag where it is farthest from its bound.
struct ComponentCorrelation {
  std::size_t lag = 0;  ///< 0 if none is tested
  double correlation = kNaN;
  double bound = kNaN;
  /// The mean over all runs and scans, and the distance from 0 that white innovations do not exceed
  /// in any component. It is judged together with all correlations.
  double mean = kNaN, mean_bound = kNaN;
  bool is_white() const { return lag == 0 || std::abs(correlation) <= bound; }
  bool has_bias() const { return std::abs(mean) > mean_bound; }
};

/// Test of the NIS, which needs no truth. For a consistent filter its expectation is 1 for each
/// degree of freedom, and the innovations are white: independent from scan to scan.
struct Innovations {
  /// {scan} NIS divided by its degrees of freedom, average over runs; NaN if there is none.
  std::vector<double> average;
  std::vector<Interval> bounds;  ///< {scan} chi-square bounds of the average
  /// Share of the scans with a degree of freedom whose average is inside the bounds.
  double share_inside = 0.0;
  /// NIS over degrees of freedom: that of the verdict if it judges the size, else that of all runs
  /// and scans together.
  double ratio = kNaN;
  /// Verdict on size, stretches and scans unless the innovations are shown not to be white. If they
  /// are, it is on the size by the means of runs, or untested for fewer than kFewestRunsOfSize
  /// runs.
  Verdict verdict;
  /// {lag - 1} autocorrelation over all runs of the NIS to the power 2/3; NaN if not tested.
  std::vector<double> autocorrelation;
  /// {lag - 1} bound of the autocorrelation; white innovations stay within it at all lags with the
  /// probability of the level.
  std::vector<double> white_bound;
  /// Lag with the largest ratio of autocorrelation to bound; 0 if none is tested.
  std::size_t worst_lag = 0;
  LargestInnovation largest;
  /// {component} correlations of the components; empty if they are not known.
  std::vector<ComponentCorrelation> components;

  /// Whether `verdict` judges the size. If components are known, the verdict on errors does.
  bool judges_size() const { return components.empty(); }
  Whiteness whiteness() const;
  /// By the NIS alone, without the components.
  Whiteness whiteness_of_nis() const;
  /// Returns whether the largest innovation decides a finding: without it the whiteness is another
  /// one, or only with it or only without it the size is shown to be off.
  bool are_decided_by_largest() const;
};

/// The verdict on the components of innovations of a few drives if they are white.
struct VerdictOnWhite {
  Verdict verdict;
};

/// The findings in words: "white, consistent", "not white, size optimistic", "not white, size not
/// judged", ...; "white" if no size is judged.
std::string whiteness_in_words(Whiteness whiteness, std::optional<Answer> size);

std::string whiteness_in_words(const Innovations& found);
/// The findings without the largest innovation.
std::string whiteness_without_largest(const Innovations& found);

/// The run with the largest innovation.
struct LargestRun {
  /// Normal score of that innovation: standard normal for a consistent filter.
  double deviate = 0.0;
  std::uint64_t run = 0;
  std::uint64_t scan = 0;
  double time = 0.0;  ///< [s] time of the scan
  std::vector<double> nis;
  std::vector<std::uint32_t> dof;
  static constexpr auto members() {
    return std::tuple(&LargestRun::deviate, &LargestRun::run, &LargestRun::scan, &LargestRun::time,
                      &LargestRun::nis, &LargestRun::dof);
  }
};

/// Sums over pairs of numbers of a run that are up to kInnovationLags apart, over all runs.
class LaggedProducts {
 public:
  LaggedProducts() = default;  ///< empty sums, to be filled by a SumReader
  explicit LaggedProducts(std::size_t scans)
      : products_(1 + std::min(kInnovationLags, scans / 4)) {}

  /// Adds the numbers of one run, of which NaN are left out.
  void add(std::span<const double> numbers);
  /// Largest lag that is tested if `runs` runs were added: at most a quarter of their numbers.
  std::size_t lags(std::uint64_t runs) const;
  double mean() const { return products_[0].both / (2.0 * products_[0].n); }
  /// Number of pairs at a lag, and their correlation; NaN if there is none.
  double pairs(std::size_t lag) const { return products_[lag].n; }
  double correlation(std::size_t lag) const;
  /// Skewness of the numbers.
  double skewness() const;
  static constexpr auto parts() {
    return std::tuple(added(&LaggedProducts::products_, &LaggedProducts::cubes_));
  }

 private:
  struct Products {
    double n = 0.0;        ///< number of pairs
    double both = 0.0;     ///< sum over all pairs of both members
    double product = 0.0;  ///< sum of the products
    double mean_product(double mean) const { return product / n - mean * both / n + mean * mean; }
    static constexpr auto parts() {
      return std::tuple(added(&Products::n, &Products::both, &Products::product));
    }
  };

  std::vector<Products> products_;  ///< {lag from 0}
  double cubes_ = 0.0;              ///< sum of the cubes of the numbers
  /// The numbers of the run that is added, the last one first, and 1 where there is one; behind
  /// them zeros.
  std::vector<double> numbers_, is_there_;
};

/// Adds up the NIS over runs.
class InnovationSums {
 public:
  /// Runs with measurements of their own are independent. Runs on one recorded drive have the same
  /// measurements, so that only the first one counts.
  enum class Measurements { own, same };
  /// Innovations of `components` components are also correlated component by component.
  explicit InnovationSums(std::size_t scans, std::size_t components = 0,
                          Measurements measurements = Measurements::own)
      : measurements_(measurements),
        others_(scans),
        components_(components, LaggedProducts(scans)) {}

  /// Adds the innovations of run number `run`: `times` [s], `nis` and `dof`, all {scan}; and, if
  /// components are known, each in units of its deviation, `standardised` {scan, component}, NaN
  /// where there is none.
  void add(std::uint64_t run, std::span<const double> times, std::span<const double> nis,
           std::span<const std::uint32_t> dof, std::span<const double> standardised = {});
  bool empty() const { return !largest_; }
  /// The test. There must be an innovation. `times` [s] of the scans; `level` of the whiteness and
  /// of bounds, `within` the margin; `gate` that they passed, nullptr if none.
  Innovations result(std::span<const double> times, double level, double within,
                     const GateScale* gate = nullptr) const;
  static constexpr auto parts() {
    using Sums = InnovationSums;
    return std::tuple(Part{[](Sums& sums, Sums& next) { sums.merge(next); },
                           std::tuple(&Sums::others_, &Sums::largest_, &Sums::components_)});
  }

 private:
  /// Sums over whole runs.
  struct Totals {
    explicit Totals(std::size_t scans);
    void add(std::span<const double> nis, std::span<const std::uint32_t> dof);
    /// The findings; the whiteness of the components is known already.
    Innovations result(std::span<const double> times, double level, double within,
                       const GateScale* gate, std::vector<ComponentCorrelation> components) const;
    /// Number of runs with an innovation.
    std::uint64_t runs() const { return nis_.ratios().n; }
    static constexpr auto parts() {
      return std::tuple(added(&Totals::nis_, &Totals::products_, &Totals::spreads_));
    }

   private:
    void find_correlations(double level, Innovations& result) const;
    void judge_size(std::span<const double> times, double level, double within,
                    const GateScale* gate, Innovations& result) const;

    SummedError nis_;                       ///< {scan} sums of the NIS
    LaggedProducts products_;               ///< of the standardised NIS
    std::vector<SpreadOfSquares> spreads_;  ///< {stretch} of the NIS
  };
  void merge(InnovationSums& next);
  std::vector<ComponentCorrelation> correlated_components(std::uint64_t runs, double level) const;

  Measurements measurements_;
  Totals others_;  ///< sums over all runs except that of `largest_`
  /// Run that is counted with its largest innovation and without it.
  std::optional<LargestRun> largest_;
  std::vector<LaggedProducts> components_;  ///< {component}
};

}  // namespace montecarta::analysis
