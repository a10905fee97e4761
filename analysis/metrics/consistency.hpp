// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/nees_bounds.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// The average NEES leaves its band for good when it stays above the upper bound for so many
/// consecutive scans (5 s at 5 Hz); a single scan above it means nothing (STATISTICS 5).
inline constexpr std::size_t kLastingScans = 25;

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
  double average_deviate = 0.0;            ///< WholeRunTest, of the average over the run
  std::vector<double> run_averages;        ///< {run} over its scans; NaN where none is finite
  std::uint64_t samples = 0;               ///< scans x complete runs
  std::uint64_t floored = 0;               ///< of them: singular covariance, floor was added
  std::uint64_t undefined = 0;  ///< of them: not a number, left out of average and median
  std::uint64_t too_few = 0;    ///< of them: too few effective draws to be judged, left out as well
};

enum class Verdict {
  untested,      ///< no covariance stored, or no complete run
  consistent,    ///< neither a scan nor the whole run is farther off than chance has it
  inconsistent,  ///< too large, and leaves the pointwise band upwards for good
  optimistic,    ///< too large at some scan or over the run: errors larger than the filter says
  conservative,  ///< too small: errors smaller than the filter says
};

/// What a NeesSeries says in a few numbers. The verdict is one test at the level of the study: a
/// consistent filter is called consistent with that probability, however many scans a run has. It
/// has two parts that share the probability of a false alarm (WholeRunTest): the average over runs
/// at every scan against whole_run_bounds, and the average over runs and scans against
/// average_bounds.
struct Consistency {
  Verdict verdict = Verdict::untested;
  double mean = 0.0;                 ///< of the averages, over scans
  double median = 0.0;               ///< of the medians, over scans
  double trimmed = 0.0;              ///< of the trimmed means, over scans
  double share_inside = 0.0;         ///< of scans with a valid run; the three add up to 1
  double share_above = 0.0;          ///< pointwise band, as share_below
  double share_below = 0.0;          ///< of scans
  Interval average_bounds = {};      ///< where the mean of a consistent filter lies
  Interval average_interval = {};    ///< where the mean over infinitely many runs lies (bootstrap)
  std::optional<double> above_from;  ///< [s] first scan above whole_run_bounds
  std::optional<double> below_from;  ///< [s] first scan below them
  std::optional<double> lasting_exit;  ///< [s] first scan of the first kLastingScans above in a row
  std::optional<Interval> exit_interval;  ///< [s] of lasting_exit, by bootstrap over runs;
                                          ///< infinity: never; leading moments of the pose only
};

/// Where the average over runs and scans of a consistent filter lies: its mean is `dimension`; its
/// deviation that of `run_averages`, in proportion to their mean, but at most what a single scan
/// has; its shape a gamma (of one scan: the chi-square of nees_bounds()), between the quantiles at
/// which a normal distribution has `deviate` deviations. Everything where there are fewer than
/// three runs. Of few runs of nearly constant NEES the estimated deviation is noisier than a
/// chi-square says: of 20 or 30 the verdict accuses about 6 % of consistent filters at a level of
/// 95 %.
Interval run_average_bounds(std::span<const double> run_averages, std::size_t dimension,
                            double deviate);

/// What a consistent filter has for Consistency::median and ::trimmed.
double expected_median(std::size_t dimension);
double expected_trimmed(std::size_t dimension);

/// Index at which the first `length` consecutive true values begin; nullopt = never.
std::optional<std::size_t> first_lasting(const std::vector<bool>& above, std::size_t length);

/// Judges a series by its bounds and its average_deviate; `times` [s] of its scans.
Consistency judge(const NeesSeries& series, std::span<const double> times);

/// The verdict as one reads it: "consistent", "inconsistent from 4.2 s", ...
std::string in_words(const Consistency& consistency);

}  // namespace montecarta::analysis
