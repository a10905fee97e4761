// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/sums.hpp"
#include "analysis/verdict/verdict.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Stretches of a drive that are judged by themselves, where there are scans for twice as many.
inline constexpr std::size_t kStretches = 8;

/// Adds up the NEES of every scan over runs, and tests the sums of single scans, which are exactly
/// chi-square for any correlations between the errors of a run (STATISTICS 5).
class SummedError {
 public:
  explicit SummedError(std::size_t scans = 0) : scans_(scans) {}

  /// A NEES of `dimension` components; one that is NaN is left out.
  void add(std::size_t scan, double nees, double dimension);

  struct Scan {
    double nees = 0.0, dimensions = 0.0, runs = 0.0;
    double ratio() const { return nees / dimensions; }
    static constexpr auto parts() {
      return std::tuple(added(&Scan::nees, &Scan::dimensions, &Scan::runs));
    }
  };
  const std::vector<Scan>& scans() const { return scans_; }

  /// The largest number of runs that a scan has.
  double most_runs() const;
  /// The size by the law of errors that never change within a run, which is the widest. There must
  /// be a run.
  MemberTest size_test() const;
  /// The family of scans; `times` [s].
  std::vector<MemberTest> scan_tests(std::span<const double> times) const;
  /// Size and scans alone, for errors of which only the NEES is known; none without a run.
  std::vector<FamilyTest> families(double level, std::span<const double> times) const;
  /// Size, stretches and scans of errors that are independent from scan to scan, as the innovations
  /// of a consistent filter are: all of these sums are exactly chi-square.
  std::vector<FamilyTest> white_families(double level, std::span<const double> times) const;
  static constexpr auto parts() { return std::tuple(added(&SummedError::scans_)); }

 private:
  /// The sum over scans [first, end).
  Scan sum_of(std::size_t first, std::size_t end) const;

  std::vector<Scan> scans_;
};

}  // namespace montecarta::analysis
