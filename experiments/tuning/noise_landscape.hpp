// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/tuning.hpp"
#include "engine/threads/parallel.hpp"
#include "experiments/study/make_plan.hpp"
#include "experiments/tuning/noise_factors.hpp"
#include "experiments/tuning/reference_half.hpp"
#include "experiments/tuning/scores.hpp"

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace montecarta::experiments {

/// Scans between two that a filter is given, by which its predictions are scored (STATISTICS 23).
inline constexpr std::array<std::size_t, 3> kPredictionIntervals = {1, 3, 10};

/// A pair of factors on the lattice of the search, in eighths of an octave: 8 is a factor of 2.
struct LatticePoint {
  int motion = 0;
  int sensor = 0;
  bool operator==(const LatticePoint&) const = default;
  bool operator<(const LatticePoint& other) const {
    return std::pair(motion, sensor) < std::pair(other.motion, other.sensor);
  }
};
inline constexpr int kOctave = 8;
/// Farthest point of the lattice: a factor of 64.
inline constexpr int kFarthest = 6 * kOctave;

double factor_at(int place);
NoiseFactors factors_at(const LatticePoint& point);

/// Scores of a part of the data, by prediction interval.
using PartScores = std::array<ScoreSum, kPredictionIntervals.size()>;

/// Indices in kPredictionIntervals.
using Intervals = std::vector<std::size_t>;

/// The scores of one cell as functions of the noise that it assumes, computed where they are asked
/// for: the log score of the pose at all scans where there is a truth, or else that of the errors
/// at the fixes of a reference, or of the innovations, in the first half of each recorded drive.
class NoiseLandscape {
 public:
  /// Throws StudyError if there are too few runs, scans or fixes to learn from, or if the cell as
  /// it is shows that the reference cannot be used.
  NoiseLandscape(const Study& study, const CellSpec& cell, TuningScore score,
                 const Parallel& parallel);

  TuningScore score() const { return score_; }
  bool has_truth() const { return score_ == TuningScore::truth; }
  /// Number of runs, or of recorded drives.
  std::uint64_t runs() const { return runs_; }
  /// Number of parts of the data, which count as independent: runs, or stretches of drives.
  std::size_t parts() const { return runs_ * parts_of_run_; }
  /// The prediction intervals for which there are enough scans.
  const Intervals& intervals() const { return intervals_; }

  /// Computes the scores of the first `runs` runs at all points that lack them.
  void compute(std::span<const LatticePoint> points, std::uint64_t runs);
  /// Mean score of the first `runs` runs at a point that was computed, over all scans that are
  /// scored at these intervals; infinite where the filter fails.
  double mean(const LatticePoint& point, std::uint64_t runs, const Intervals& intervals) const;
  /// Returns whether the filter fails in one of the first `runs` runs.
  bool has_failed(const LatticePoint& point, std::uint64_t runs, const Intervals& intervals) const;
  /// {part} Shares of the parts in mean() of all runs, which has the mean over parts.
  std::vector<double> shares(const LatticePoint& point, const Intervals& intervals) const;
  /// The number of independent samples whose average NEES varies as much as that of the errors at
  /// the fixes (STATISTICS 20), with the noise of a point; parts() if no reference is used.
  double effective_samples(const LatticePoint& point) const;
  /// Number of fixes that are scored, and of gross outliers among them by the cell as it is
  /// (STATISTICS 20); 0 if no reference is used.
  std::size_t fixes() const { return fixes_; }
  std::size_t outliers() const { return outliers_; }

 private:
  /// The scores of a point.
  struct ScoredPoint {
    std::vector<PartScores> parts;
    std::vector<std::uint8_t> has_failed;  ///< {run, interval}
    std::uint64_t runs(std::size_t parts_of_run) const { return parts.size() / parts_of_run; }
  };
  /// A point whose runs from `first_run` on are computed.
  struct Work {
    ScoredPoint* point;
    std::uint64_t first_run;
    const Cell* cell;
    InnovationScore innovation_score;
  };
  std::size_t scans_of(std::uint64_t run) const;
  /// Number of the first scan whose score counts (study.judge_from).
  std::size_t first_scan_of(std::uint64_t run) const;
  void compute(const std::vector<Work>& work, std::uint64_t runs) const;
  void score(const Work& work, std::uint64_t run, const Drive& drive, std::size_t interval) const;
  bool score_scans(const Work& work, const DrivePart& part, std::size_t interval) const;
  bool score_fixes(const Work& work, const DrivePart& part, std::size_t interval) const;
  ScoreSum& scores_at(const Work& work, std::uint64_t run, std::size_t part,
                      std::size_t interval) const;
  /// The estimates of the cell of a study at the fixes of a drive; nullopt if it fails.
  std::optional<RunRows> estimates_of(const Cell& cell, std::uint64_t run) const;
  void take_references();
  void find_intervals(const Study& study);

  Study study_;
  CellSpec cell_;
  const Parallel& parallel_;
  StudyPlan plan_;
  TuningScore score_;
  std::uint64_t runs_;
  std::size_t parts_of_run_;
  std::vector<ReferenceHalf> references_;  ///< {run} empty if no reference is used
  std::size_t fixes_ = 0, outliers_ = 0;
  Intervals intervals_;
  std::map<LatticePoint, ScoredPoint> points_;
};

}  // namespace montecarta::experiments
