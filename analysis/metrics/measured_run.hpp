// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_reader.hpp"
#include "analysis/data/run_rows.hpp"
#include "analysis/metrics/calibration.hpp"
#include "analysis/metrics/drive.hpp"
#include "analysis/metrics/joint_nees.hpp"
#include "analysis/metrics/lineages.hpp"
#include "analysis/metrics/map_errors.hpp"
#include "analysis/metrics/nees.hpp"
#include "analysis/metrics/proper_scores.hpp"
#include "analysis/metrics/references.hpp"
#include "analysis/verdict/verdict.hpp"
#include "analysis/verdict/whole_error.hpp"
#include "engine/records/result_file.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// NEES of one run by one definition of the moments; empty where no covariance is stored.
struct NeesRows {
  std::array<std::size_t, 3> dimension = {3, 2, 1};  ///< {block} components
  /// {block}{scan} on the scale of all components (on_full_scale()); NaN if a sample cannot be
  /// judged. Blocks other than the first may be empty.
  std::array<std::vector<double>, 3> value;
  std::array<std::vector<int>, 3> rank;  ///< {block}{scan} of the covariance, as Nees::rank
  /// {block}{scan} too few effective draws to be judged (SamplerScale), value NaN; empty where the
  /// moments are not corrected.
  std::array<std::vector<std::uint8_t>, 3> too_few;

  void set(std::size_t block, std::size_t scan, const Nees& sample) {
    value[block][scan] = sample.value;
    rank[block][scan] = sample.rank;
  }
  void resize(std::size_t scans) {
    for (auto& values : value) values.resize(scans);
    for (auto& ranks : rank) ranks.resize(scans);
  }
};

/// The scales for the draws of a scan.
struct DrawsScales {
  double draws = 0.0;  ///< EffectiveDraws::of_mean
  /// {components - 1} nullopt where the draws are too few.
  std::array<std::optional<SamplerScale::Line>, 3> of;
};

/// The heading by which errors are turned to forward and left. It must not depend on the error, or
/// even a consistent filter has a bias in that frame (STATISTICS 5).
enum class ErrorFrame {
  of_estimate,  ///< heading of the mean that is judged: where the truth scatters about the data.
                ///< The mean of a few drawn poses is corrected for its own error.
  of_truth      ///< true heading: where it is the same in all runs
};

/// Errors and NEES of one run at every scan. Keeps its memory from run to run; one per thread.
class RunMetrics {
 public:
  /// Reads `rows` of a complete run with `particles` (0: none); `times` [s] of the scans. Without
  /// truth there are no errors and no NEES: their rows are empty.
  void measure(const RunRows& rows, std::size_t particles, std::span<const double> times,
               ErrorFrame frame);

  const NeesRows& nees(Moments moments) const { return nees_[static_cast<std::size_t>(moments)]; }
  /// NEES by the first of kMoments that is stored; nullptr if none is.
  const NeesRows* leading_nees() const;
  /// Errors in units of the covariance of the leading moments, in the ErrorFrame, or in the
  /// convention of imported estimates. Errors of drawn poses are on the scale of the normal law
  /// (SamplerScale). Dimension 0 if there is no covariance.
  const WhitenedRun& whitened() const { return whitened_; }
  /// [m^2] {scan}, of the mean of estimate_of().
  const std::vector<double>& squared_position() const { return squared_position_; }
  /// [rad^2] {scan}
  const std::vector<double>& squared_heading() const { return squared_heading_; }
  /// {scan} errors of the same mean, estimate - truth, in the ErrorFrame: forward [m], left [m],
  /// heading [rad].
  const std::vector<Eigen::Vector3d>& errors() const { return errors_; }
  /// {scan} covariance of estimate_of() in the same frame; empty where none is stored.
  const std::vector<Eigen::Matrix3d>& covariances() const { return covariances_; }
  /// {scan} those errors in units of that covariance; empty where none is stored.
  const std::vector<WhitenedPose>& estimates() const { return estimates_; }
  /// nullptr if no ancestry is stored; likewise lineages().
  const Diversity* diversity() const { return diversity_; }
  const Lineages* lineages() const { return lineages_ ? &*lineages_ : nullptr; }

 private:
  void measure_errors(const RunRows& rows, std::size_t scans, ErrorFrame frame);
  void correct_and_whiten(const RunRows& rows, std::size_t particles, ErrorFrame frame);
  void correct_spread(std::size_t s, const std::optional<DrawsScales>& scales);
  void whiten_pose(const RunRows& rows, std::size_t s, const std::optional<DrawsScales>& scales,
                   ErrorFrame frame);

  std::array<NeesRows, kMoments.size()> nees_;  ///< {Moments}
  WhitenedRun whitened_;
  std::vector<double> squared_position_, squared_heading_;
  std::vector<Eigen::Vector3d> errors_;
  std::vector<Eigen::Matrix3d> covariances_;
  std::vector<WhitenedPose> estimates_;
  DiversityCounter counter_;
  const Diversity* diversity_ = nullptr;
  LineageWalker walker_;
  std::optional<Lineages> lineages_;
};

/// Criteria for a run on a drive of its own.
struct DriveCriteria {
  std::span<const double> times;          ///< [s] of the scans
  std::vector<PathAtFixes> references;    ///< as many as those of RunCriteria
  std::vector<PathAtFixes> judged_fixes;  ///< likewise
};

/// Criteria for runs, common to all cells of a file, which must outlive them.
struct RunCriteria {
  std::span<const double> times;  ///< [s] of the scans
  double level = 0.95;            ///< of NEES bounds
  double within = kUsualMargin;   ///< margin of the verdict (judge())
  std::vector<PathAtFixes> references;
  std::vector<Eigen::Vector2d> beacons;        ///< [m]
  MapCriteria map;                             ///< of a simulation
  std::span<const std::uint32_t> joint_scans;  ///< of joint estimates
  std::vector<PathAtFixes> judged_fixes = {};  ///< of the scans, of references with known errors
  ErrorFrame frame = ErrorFrame::of_truth;
  bool calibrates = false;  ///< whether the PITs of errors are judged: only with matched noise
  /// Runs at each interim analysis, if cells stop when their verdict is known.
  std::vector<std::uint64_t> looks = {};
  double share_of_runs = 1.0;  ///< of the study's that the file has: less than 1 in a shard
  /// Components of the errors that are judged.
  std::vector<std::string> components = {};
  /// {run of the study} Empty if all runs process one drive. Otherwise `times` are those of the
  /// longest drive, and references and judged_fixes those of the first. Such drives are recordings
  /// without truth: they have no errors and no NEES.
  std::vector<DriveCriteria> drives = {};

  /// Level of a verdict on so many runs, so that all interim analyses together have `level`.
  double verdict_level(std::uint64_t runs) const;
};

RunCriteria criteria_of(const ResultFile& file, double level, double within = kUsualMargin);

/// One run being read and measured while others are. Keeps its memory from run to run.
struct MeasuredRun {
  RunRows rows;
  std::span<const double> times;  ///< [s] of its scans
  RunMetrics metrics;
  std::vector<ReferenceRun> references;
  std::vector<DriveScores> drives;      ///< by each of RunCriteria::judged_fixes
  std::optional<BeaconScores> beacons;  ///< where the final map is stored and beacons are known
  std::optional<MapScores> map;         ///< where it is stored and the world is known
  std::vector<JointScore> joint;        ///< where joint estimates are stored
  bool has_identities = false;          ///< whether anybody knows which landmark is which
  RunPits pits;                         ///< of errors and NEES
  ProperScores proper;                  ///< of a known truth

  /// Measures `rows` of a complete run.
  void measure(const RunCriteria& criteria, std::size_t particles);
};

}  // namespace montecarta::analysis
