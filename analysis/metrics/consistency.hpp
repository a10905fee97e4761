// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/study_settings.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/statistics/whole_run_band.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// A single run is lost when its NEES stays above its upper bound for so many consecutive scans
/// (5 s at 5 Hz); a single scan above it means nothing (STATISTICS 7).
inline constexpr std::size_t kLastingScans = 25;

/// Probability with which Consistency::least_ratios would have been found.
inline constexpr double kPowerSaid = 0.9;

/// The trimmed mean of NEES leaves out so large a share of the runs at either end.
inline constexpr double kTrimmedShare = 0.1;

/// NEES of one definition of error and covariance over scans and runs.
struct NeesSeries {
  std::size_t dimension = 0;
  std::vector<double> average;             ///< {scan} over valid runs; NaN where there is none
  std::vector<double> median;              ///< {scan} over valid runs, to 3 %
  std::vector<double> trimmed;             ///< {scan} mean without kTrimmedShare of the runs at
                                           ///< either end, to 3 %
  std::vector<std::uint32_t> runs;         ///< {scan} valid: complete, with a finite NEES
  std::vector<Interval> bounds;            ///< {scan} of the average at that scan, from `runs`
  std::vector<Interval> whole_run_bounds;  ///< {scan} of the average at all scans together
  WholeRunTest test;                       ///< what the average over the run is tested by
  std::vector<double> run_averages;        ///< {run} over its scans, of runs that have any NEES
  std::uint64_t samples = 0;               ///< scans x complete runs
  std::uint64_t lower_rank = 0;  ///< of them: judged in the range of a singular covariance
  std::uint64_t unusable = 0;    ///< of them: error or covariance is not finite, or the covariance
                                 ///< not positive semidefinite; left out of average and median
  std::uint64_t too_few = 0;  ///< of them: too few effective draws to be judged, left out as well
  std::uint64_t unjudged_runs = 0;  ///< complete runs without a NEES at any scan, left out as well
};

enum class Verdict {
  untested,      ///< no covariance stored, or no complete run
  consistent,    ///< shown to be within the margin: over the run, and not shown beyond it anywhere
  optimistic,    ///< shown too large at some scan or over the run: errors larger than it says
  conservative,  ///< shown too small: errors smaller than the filter says
  undecided,     ///< neither is shown: more runs are needed
};

/// The ratio of a scan's average to the expected one, by the band for all scans.
struct ScanRatio {
  Interval ratio;
  double time = 0.0;  ///< [s]
};

/// What a NeesSeries says in a few numbers. One test at the level of the study has two parts that
/// share the probability of a false rejection (WholeRunTest): the average over runs at every scan
/// against whole_run_bounds, and the average over runs and scans against average_bounds. A
/// consistent filter stays inside both with the probability `level`, however many scans a run has.
/// Its interval, `ratio`, and the same bands in units of the margin show that a filter is
/// consistent (STATISTICS 5).
struct Consistency {
  Verdict verdict = Verdict::untested;
  std::uint64_t runs = 0;         ///< that ended, complete or failed
  std::uint64_t failed = 0;       ///< of them
  std::uint64_t samples = 0;      ///< of the complete runs, one a scan
  std::uint64_t unusable = 0;     ///< of them, as NeesSeries::unusable
  double within = kUsualMargin;   ///< the margin: ratios in [1 / within, within] are consistent
  Interval ratio = {};            ///< where the expected average over the run, divided by the right
                                  ///< one, lies; 1 is in it where average_bounds hold the mean
  bool is_overdispersed = false;  ///< some runs are lost and others not: `ratio` by bootstrap
  Interval least_ratios = {};     ///< found with probability kPowerSaid, below and above 1
  std::optional<ScanRatio> highest;  ///< of the scans outside the band for all that farthest above
  std::optional<ScanRatio> lowest;   ///< and that farthest below
  std::optional<std::uint64_t> more_runs;  ///< that decide what is undecided; none known: nullopt
  double mean = 0.0;                       ///< of run_averages
  double median = 0.0;                     ///< of the medians, over scans
  double trimmed = 0.0;                    ///< of the trimmed means, over scans
  double share_inside = 0.0;               ///< of scans with a valid run; the three add up to 1
  double share_above = 0.0;                ///< pointwise band, as share_below
  double share_below = 0.0;                ///< of scans
  Interval average_bounds = {};            ///< where the mean of a consistent filter lies
  Interval average_interval = {};    ///< where the mean over infinitely many runs lies (bootstrap)
  std::optional<double> above_from;  ///< [s] first scan above whole_run_bounds
  std::optional<double> below_from;  ///< [s] first scan below them
  std::optional<double> stays_above_from;  ///< [s] from here to the end above whole_run_bounds
  std::optional<double> stays_below_from;  ///< [s] from here to the end below them
};

/// What a consistent filter has for Consistency::median and ::trimmed.
double expected_median(std::size_t dimension);
double expected_trimmed(std::size_t dimension);

/// Index at which the first `length` consecutive true values begin; nullopt = never.
std::optional<std::size_t> first_lasting(const std::vector<bool>& above, std::size_t length);

/// Judges a series by its bounds and its test; `times` [s] of its scans, `within` the margin, above
/// 1.
Consistency judge(const NeesSeries& series, std::span<const double> times,
                  double within = kUsualMargin);

/// The verdict as one reads it: "consistent within 1.1", "optimistic by 1.2 to 1.4", "optimistic by
/// 1.3 to 2.5 at 12.4 s" where no other scan nor the run shows it, "undecided: 130 more runs
/// decide", ... Failed runs and unusable samples are part of it: "consistent within 1.1 in what can
/// be judged (3 of 300 runs failed)".
std::string in_words(const Consistency& consistency);

/// What a script does with a filter: let it pass, stop it, or wait for more runs.
enum class GateAnswer : std::uint8_t { consistent, inconsistent, undecided };

struct Gate {
  GateAnswer answer = GateAnswer::undecided;
  std::string why;  ///< one line without the name of what was judged
};

/// What a gate lets pass. More than these are inconsistent whatever the NEES.
struct Allowance {
  std::uint64_t failed = 0;    ///< runs
  std::uint64_t unusable = 0;  ///< samples
};

/// The answer that a verdict gives within its margin. Throws StudyError if the verdict is
/// `untested` and nothing failed: there was nothing to judge.
Gate gate(const Consistency& found, const Allowance& allowed = {});

}  // namespace montecarta::analysis
