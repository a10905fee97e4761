// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/run_mean.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/verdict/verdict.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Stretches of a drive that are judged by themselves, where there are scans for twice as many.
inline constexpr std::size_t kStretches = 8;

/// A ratio of squared errors to the expected ones by the runs, as a member of `family`.
MemberTest ratio_test(Family family, Member member, const RunMean& ratio);

/// Adds up the NEES of every scan over runs, and of every run over scans (STATISTICS 5).
class SummedError {
 public:
  explicit SummedError(std::size_t scans = 0) : scans_(scans) {}

  /// One run: its NEES {scan}, which is NaN where it is not judged, of errors of `dimension`
  /// components. A run on a drive of its own may have fewer scans.
  void add(std::span<const double> nees, double dimension);
  /// Likewise, with as many components {scan} as each error has.
  void add(std::span<const double> nees, std::span<const double> dimensions);

  struct Scan {
    double nees = 0.0, dimensions = 0.0;
    SummaryOf runs = {};  ///< of the NEES of a run by its components
    double ratio() const { return nees / dimensions; }
    double n() const { return static_cast<double>(runs.result().n); }
    static constexpr auto parts() {
      return std::tuple(added(&Scan::nees, &Scan::dimensions, &Scan::runs));
    }
  };
  const std::vector<Scan>& scans() const { return scans_; }
  /// The ratio of squared errors to the expected ones of a run, over runs that have any.
  Summary ratios() const { return ratios_.result(); }

  /// The size by the runs.
  MemberTest size_test() const;
  /// The family of scans; `times` [s].
  std::vector<MemberTest> scan_tests(std::span<const double> times) const;
  /// Size and scans alone, for errors of which only the NEES is known; none without a run.
  std::vector<FamilyTest> families(double level, std::span<const double> times) const;
  /// Size, stretches and scans of errors that are independent from scan to scan, as the innovations
  /// of a consistent filter are: all of these sums are exactly chi-square.
  std::vector<FamilyTest> white_families(double level, std::span<const double> times) const;
  static constexpr auto parts() {
    return std::tuple(added(&SummedError::scans_, &SummedError::ratios_));
  }

 private:
  /// The skewness of the ratio of a run at a scan, by all scans together.
  double common_skewness() const;

  std::vector<Scan> scans_;
  SummaryOf ratios_;
};

}  // namespace montecarta::analysis
