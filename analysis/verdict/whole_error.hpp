// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/whitened_run.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/verdict/along_drive.hpp"
#include "analysis/verdict/bets.hpp"
#include "analysis/verdict/gate_scale.hpp"
#include "analysis/verdict/run_groups.hpp"
#include "analysis/verdict/summed_error.hpp"
#include "analysis/verdict/worst_direction.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Names of the components and times [s] of the scans, for the members of families.
struct ErrorNames {
  std::span<const std::string> components;
  std::span<const double> times;
};

/// Sum and count of numbers of one run; NaN is left out.
struct MeanOfRun {
  double sum = 0.0, n = 0.0;
  void add(double value) {
    if (std::isnan(value)) return;
    sum += value;
    n += 1.0;
  }
  void add(const MeanOfRun& other) {
    sum += other.sum;
    n += other.n;
  }
  double mean() const { return sum / n; }  ///< NaN without numbers
  void end_run(SummaryOf& runs) const {
    if (n > 0.0) runs.add(mean());
  }
};

/// Adds up the errors of the complete runs of one cell and tests them (STATISTICS 5). Memory
/// depends on scans and components, and grows by two numbers with every run. If there are more than
/// kMostComponentsInPairs components, the errors of the first runs are kept, at most 256 of them.
class WholeError {
 public:
  /// The most components of which all pairs are tested. For more, direction_tests() judge
  /// correlations.
  static constexpr std::size_t kMostComponentsInPairs = 6;

  WholeError() = default;  ///< empty sums, to be filled by a SumReader
  WholeError(std::size_t dimension, std::size_t scans);

  /// Adds one run with its NEES {scan}, which is NaN where it is not judged.
  void add(const WhitenedRun& run, std::span<const double> nees);
  /// The families that apply, judged together at `level`. Size and components of fewer than
  /// kFewestRunsOfAPlan runs are judged along the drives if errors forget fast; fewer than
  /// kFewestJudgedRuns runs have no other families but the scans.
  /// Behind a `gate` ratios are factors, and single components have no tests of their squares: how
  /// much of one passes depends on the others (STATISTICS (9.4)).
  std::vector<FamilyTest> families(double level, const ErrorNames& names,
                                   const GateScale* gate = nullptr) const;
  /// The families of fewer than kFewestRunsOfAPlan runs whose errors are white, as innovations of a
  /// consistent filter are: size, components and stretches are judged by the law of such errors.
  /// Empty if there are more runs.
  std::vector<FamilyTest> white_families(double level, const ErrorNames& names,
                                         const GateScale* gate = nullptr) const;
  /// The side of the margin on which bets on the ratios of runs refuse the filter (STATISTICS 18).
  std::optional<Side> refused_by_bets(double margin, double level) const;
  /// Findings that are in no test.
  BesideTests beside_tests(const ErrorNames& names) const;
  static constexpr auto parts() {
    using Sums = WholeError;
    return std::tuple(
        settings(&Sums::dimension_, &Sums::ends_),
        added(&Sums::nees_, &Sums::stretch_, &Sums::against_run_, &Sums::component_, &Sums::bias_,
              &Sums::correlation_, &Sums::whitened_mean_, &Sums::groups_, &Sums::largest_,
              &Sums::exact_, &Sums::bets_),
        appended(&Sums::fingerprints_, &Sums::numbers_),
        appended_up_to(&Sums::most_kept_runs, &Sums::whitened_),
        // Merged, and not stored: sums are of many runs.
        Part{[](Sums& sums, Sums& next) { sums.along_.merge(next.along_); }, std::tuple()});
  }

 private:
  /// Summaries over runs of a number over the whole drive, and in each of its stretches.
  struct OverDrive {
    SummaryOf whole;
    std::vector<SummaryOf> stretch;
    static constexpr auto parts() {
      return std::tuple(added(&OverDrive::whole, &OverDrive::stretch));
    }
  };
  struct Maximum {
    double value = 0.0;
    void merge(const Maximum& next) { value = std::max(value, next.value); }
    static constexpr auto members() { return std::tuple(&Maximum::value); }
  };
  /// The largest error of all, in deviations of its component.
  struct Largest {
    struct ErrorPlace {
      std::uint64_t run = 0, scan = 0, component = 0;
      static constexpr auto members() {
        return std::tuple(&ErrorPlace::run, &ErrorPlace::scan, &ErrorPlace::component);
      }
    };
    double deviations = 0.0;
    ErrorPlace place = {};
    std::uint64_t samples = 0;  ///< number of errors among which it is the largest
    void add(double error, const ErrorPlace& where);
    void merge(const Largest& next);
    static constexpr auto members() {
      return std::tuple(&Largest::deviations, &Largest::place, &Largest::samples);
    }
  };

  bool has_pairs() const { return dimension_ <= kMostComponentsInPairs; }
  std::size_t stretches() const { return ends_.size(); }
  std::size_t most_kept_runs() const;
  std::size_t first_scan(std::size_t stretch) const {
    return stretch == 0 ? 0 : ends_[stretch - 1];
  }
  /// Whether the errors of all runs are kept to be judged along their drives.
  bool has_drives() const {
    return along_.runs() < kFewestRunsOfAPlan && along_.runs() == nees_.ratios().n;
  }
  std::vector<MemberTest> tests_over_runs(const ErrorNames& names) const;
  std::vector<MeanOfRun> ratios_of(const WhitenedRun& run, std::span<const double> nees) const;
  void add_stretches(std::span<const MeanOfRun> ratios);
  void add_components(const WhitenedRun& run);
  void add_correlations(const WhitenedRun& run);
  void add_fingerprint(const WhitenedRun& run);
  Member in_stretch(std::string name, std::size_t stretch, const ErrorNames& names) const;
  void add_stretch_tests(const ErrorNames& names, std::vector<MemberTest>& all) const;
  template <class Test>
  void add_tests(const OverDrive& number, const std::string& name, const ErrorNames& names,
                 Test test, std::vector<MemberTest>& all) const;
  double product_of_biases(std::size_t a, std::size_t b, std::size_t stretch) const;
  void add_correlation_tests(const ErrorNames& names, std::vector<MemberTest>& all) const;
  void add_largest_test(const ErrorNames& names, std::vector<MemberTest>& all) const;
  void judge_along_drives(const ErrorNames& names, std::vector<MemberTest>& all) const;

  std::size_t dimension_ = 0;
  std::vector<std::size_t> ends_;  ///< {stretch} 1 + its last scan
  SummedError nees_;
  std::vector<SummaryOf> stretch_;  ///< {stretch} ratio of each run in the stretch
  /// {stretch} ratio of each run in the stretch minus its ratio over the whole drive.
  std::vector<SummaryOf> against_run_;
  std::vector<OverDrive> component_, bias_;  ///< {component} squared errors, and errors
  std::vector<OverDrive> correlation_;       ///< {pair of components} products of whitened errors
  /// {component} means of whitened errors, if pairs are tested.
  std::vector<OverDrive> whitened_mean_;
  RunGroups groups_;
  /// {family}{member} bets on the size, on each component and on each stretch.
  std::vector<std::vector<Bets>> bets_;
  AlongDrive along_;
  Largest largest_;
  std::vector<Maximum> exact_;  ///< {component} largest error where the deviation is 0
  /// {run} fingerprint of the errors of a run, and number of that run.
  std::vector<std::uint64_t> fingerprints_, numbers_;
  ErrorsOfRuns whitened_;  ///< {run} whitened errors of the first runs
};

}  // namespace montecarta::analysis
