// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/run_mean.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/verdict/verdict.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Number of stretches of a drive that are judged by themselves, if there are twice as many scans.
inline constexpr std::size_t kStretches = 8;

/// {stretch} 1 + its last scan, of a drive of `scans` scans; one stretch if there are too few.
std::vector<std::size_t> ends_of_stretches(std::size_t scans);

/// How much squared errors vary, each of its own number of components (STATISTICS (9.5)).
class SpreadOfSquares {
 public:
  void add(double nees, double dimension) {
    nees_ += nees * nees;
    both_ += nees * dimension;
    dimensions_ += dimension * dimension;
  }
  void add(const SpreadOfSquares& next) {
    nees_ += next.nees_;
    both_ += next.both_;
    dimensions_ += next.dimensions_;
  }
  /// The variance of the errors, whose ratio and sum of components these are, in that of Gaussian
  /// ones; 1 if it is less.
  double more_than_gaussian(double ratio, double components) const {
    const double variance = nees_ / (ratio * ratio) - 2.0 * both_ / ratio + dimensions_;
    return std::max(1.0, variance / (2.0 * components));
  }
  static constexpr auto parts() {
    using Sums = SpreadOfSquares;
    return std::tuple(added(&Sums::nees_, &Sums::both_, &Sums::dimensions_));
  }

 private:
  double nees_ = 0.0, both_ = 0.0, dimensions_ = 0.0;
};

/// The test of a ratio of squared errors to the expected ones over runs, as a member of `family`.
MemberTest ratio_test(Family family, Member member, const RunMean& ratio);

/// The test of the mean of `freedom` squares of independent standard normal variables, which is the
/// estimate of `member`, by its exact law.
MemberTest chi_squared_test(Family family, Member member, double freedom);

/// Adds up the NEES of every scan over runs, and of every run over scans (STATISTICS 5).
class SummedError {
 public:
  explicit SummedError(std::size_t scans = 0) : scans_(scans) {}

  /// Adds one run: its NEES {scan}, NaN where it is not judged, for errors of `dimension`
  /// components. A run on a drive of its own may have fewer scans.
  void add(std::span<const double> nees, double dimension);
  /// Adds one run; `dimensions` {scan} is the number of components of each error.
  void add(std::span<const double> nees, std::span<const double> dimensions);

  struct Scan {
    double nees = 0.0, dimensions = 0.0;
    SummaryOf runs = {};  ///< NEES of a run divided by its components
    double ratio() const { return nees / dimensions; }
    double n() const { return static_cast<double>(runs.result().n); }
    static constexpr auto parts() {
      return std::tuple(added(&Scan::nees, &Scan::dimensions, &Scan::runs));
    }
  };
  const std::vector<Scan>& scans() const { return scans_; }
  /// Summary over runs of the ratio of squared errors to the expected ones; runs without a NEES are
  /// left out.
  Summary ratios() const { return ratios_.result(); }

  /// The test of the size by the ratios of the runs.
  MemberTest size_test() const;
  /// {scan} The tests of single scans, without those that are rounded away; `times` [s].
  std::vector<MemberTest> scan_tests(std::span<const double> times) const;
  /// The families of size and scans, for errors of which only the NEES is known; none without a
  /// run.
  std::vector<FamilyTest> families(double level, std::span<const double> times) const;
  /// The families of size, stretches and scans for errors that are independent from scan to scan,
  /// as the innovations of a consistent filter are: all of these sums are chi-square. Those of size
  /// and stretches have fewer degrees of freedom if the squares vary more than Gaussian ones, by
  /// `spreads` {stretch}.
  std::vector<FamilyTest> white_families(double level, std::span<const double> times,
                                         std::span<const SpreadOfSquares> spreads) const;
  static constexpr auto parts() {
    return std::tuple(added(&SummedError::scans_, &SummedError::ratios_));
  }

 private:
  /// Skewness of the ratio of one run at one scan, over all scans together.
  double common_skewness() const;
  /// Whether the errors of a scan, and not of all, are exactly 0 in so few runs that this happens
  /// by chance where numbers have few digits.
  bool is_rounded_away(const Scan& scan) const;

  std::vector<Scan> scans_;
  SummaryOf ratios_;
};

}  // namespace montecarta::analysis
