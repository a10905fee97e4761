// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"
#include "analysis/study/figure.hpp"
#include "analysis/study/text_table.hpp"
#include "analysis/verdict/verdict.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// A factor on standard deviations that a filter assumes, with its interval. The interval is NaN
/// if the score does not depend on the factor, which is 1 then.
struct TunedFactor {
  double value = 1.0;
  Interval interval = {};
  bool is_free() const { return interval.lower == interval.lower; }
};

/// The factors at which a score is least (STATISTICS 23).
struct TunedNoise {
  TunedFactor motion, sensor;
  /// The direction in which the factors are least certain: their logarithms one standard error
  /// from the minimum.
  double motion_apart = 0.0, sensor_apart = 0.0;
};

/// The factors by predictions over one interval alone.
struct TunedByInterval {
  std::size_t scans = 1;  ///< the filter is given every scan of so many
  std::optional<TunedNoise> noise;
};

/// Scores on a grid of factors.
struct NoiseGrid {
  std::vector<double> motion, sensor;      ///< factors of the rows and of the columns
  std::vector<std::vector<double>> score;  ///< {motion, sensor} infinite where the filter fails
  /// The least score of the grid, which tables and figures subtract.
  double least() const;
};

/// The log score that is minimised: that of the pose, of the errors at the fixes of a reference, or
/// of the innovations.
enum class TuningScore { truth, reference, innovations };

/// What a search for the noise of one cell found.
struct TuningResult {
  std::string cell;
  TuningScore score = TuningScore::truth;
  /// The reference of recorded drives, by which the noise was chosen or could have been; empty if
  /// there is none.
  std::string reference = {};
  bool reference_has_errors = false;  ///< whether it states its errors
  std::uint64_t runs = 0;             ///< number of runs, or of recorded drives
  /// Whether detections are matched by a gate, so that the score jumps where a match changes.
  bool has_gate = false;
  std::size_t parts = 0;  ///< number of parts of the data that count as independent
  /// If a reference scores the noise: the number of its fixes, of gross outliers among them, and of
  /// independent samples that the errors at the fixes are worth.
  std::size_t fixes = 0, outliers = 0;
  double effective = 0.0;
  TunedNoise noise;  ///< by all intervals together
  std::vector<TunedByInterval> by_interval = {};
  NoiseGrid grid = {};
};

/// A difference of scores with its interval.
struct ScoreDifference {
  double mean = 0.0;
  Interval interval = {};
};

/// The result of filters with the old and the new noise on data that played no part in the search.
struct TuningConfirmation {
  std::uint64_t runs = 0;
  std::uint64_t seed = 0;  ///< seed of simulated runs
  /// Number of runs, or of recorded drives, in which the filter failed with the old and with the
  /// new noise. They are not in `gain`.
  std::uint64_t failed_before = 0, failed_after = 0;
  ScoreDifference gain = {};  ///< score with the old noise minus score with the new one
  Answer answer = Answer::untested;
  bool is_slight = false;    ///< whether what is off is not shown to be beyond the margin
  std::string verdict = {};  ///< the verdict on the new noise in a few words
  /// Factors on the covariance by which its 95 % ellipsoid covers the truth in at least 95 % of
  /// runs, at the last scan, and at all scans of a run together; infinite if too many runs failed;
  /// NaN without a truth.
  double covering_at_end = 0.0, covering_path = 0.0;
  /// If a reference judges the noise: the number of its fixes, and of independent samples that they
  /// are worth.
  std::size_t fixes = 0;
  double effective = 0.0;
};

/// What the user should know before the answer: {paragraph}.
std::vector<std::string> tuning_warnings(const TuningResult& result);
/// The first sentences: the factors, how certain they are, and whether they make the filter
/// consistent.
std::string tuning_sentence(const TuningResult& result, const TuningConfirmation& confirmation);
/// What the user should know besides: {paragraph}.
std::vector<std::string> tuning_notes(const TuningResult& result,
                                      const TuningConfirmation& confirmation);

/// The factors by each prediction interval and by all of them.
TextTable tuning_table(const TuningResult& result);
/// How to read the two tables.
std::string tuning_table_note();
std::string landscape_note();
/// The grid of scores, above the least one.
TextTable landscape_table(const NoiseGrid& grid);
/// The same as columns motion_factor, sensor_factor, score.
Frame landscape_frame(const NoiseGrid& grid);
/// The same as curves over the factor on motion.
Figure landscape_figure(const TuningResult& result);

}  // namespace montecarta::analysis
