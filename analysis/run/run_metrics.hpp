// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/lineages.hpp"
#include "analysis/run/nees.hpp"
#include "analysis/run/run_rows.hpp"
#include "analysis/run/whitened_run.hpp"
#include "analysis/statistics/sampler_scale.hpp"
#include "engine/numbers/real.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// NEES of one run by one definition of the moments; empty where no covariance is stored.
struct NeesRows {
  std::array<std::size_t, 3> dimension = {3, 2, 1};  ///< {block} number of components
  /// {block}{scan} NEES on the scale of all components (on_full_scale()); NaN if a sample cannot be
  /// judged. Blocks other than the first may be empty.
  std::array<std::vector<double>, 3> value;
  std::array<std::vector<int>, 3> rank;  ///< {block}{scan} Nees::rank of the covariance
  /// {block}{scan} 1 where there are too few effective draws to judge (SamplerScale); the value is
  /// NaN there. Empty if the moments are not corrected.
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

/// The scales for the number of effective draws of a scan.
struct DrawsScales {
  double draws = 0.0;  ///< EffectiveDraws::of_mean
  /// {components - 1} scale; nullopt if there are too few draws.
  std::array<std::optional<SamplerScale::Line>, 3> of;
};

/// Names of the components of an error in its ErrorFrame.
inline constexpr std::array kErrorComponents = {"forward", "left", "heading"};

/// The heading by which errors are turned to forward and left. It must not depend on the error, or
/// even a consistent filter has a bias in that frame (STATISTICS 5).
enum class ErrorFrame {
  /// Heading of the judged mean, for studies in which the truth scatters about the data. The mean
  /// of a few drawn poses is corrected for its own error.
  of_estimate,
  of_truth  ///< true heading, for studies in which it is the same in all runs
};

/// Errors and NEES of one run at every scan. The object keeps its memory from run to run; each
/// thread has its own.
class RunMetrics {
 public:
  /// Reads `rows` of a complete run with `particles` (0: not a particle filter); `times` [s] of the
  /// scans. Without truth there are no errors and no NEES: their rows are empty.
  void measure(const RunRows& rows, std::size_t particles, std::span<const double> times,
               ErrorFrame frame);

  const NeesRows& nees(Moments moments) const { return nees_[static_cast<std::size_t>(moments)]; }
  /// NEES by the first of kMoments that is stored; nullptr if none is.
  const NeesRows* leading_nees() const;
  /// Errors in units of the covariance of the leading moments, in the ErrorFrame, or in the
  /// convention of imported estimates. Errors of drawn poses are on the scale of the normal law
  /// (SamplerScale). Dimension 0 if there is no covariance.
  const WhitenedRun& whitened() const { return whitened_; }
  /// [m^2] {scan} squared position error of the mean of estimate_of().
  const std::vector<double>& squared_position() const { return squared_position_; }
  /// [rad^2] {scan} squared heading error of the same mean.
  const std::vector<double>& squared_heading() const { return squared_heading_; }
  /// {scan} errors of the same mean, estimate - truth, in the ErrorFrame: forward [m], left [m],
  /// heading [rad].
  const std::vector<Eigen::Vector3d>& errors() const { return errors_; }
  /// {scan} covariance of estimate_of() in the ErrorFrame; empty if none is stored.
  const std::vector<Eigen::Matrix3d>& covariances() const { return covariances_; }
  /// {scan} errors() in units of covariances(); empty if no covariance is stored.
  const std::vector<WhitenedPose>& estimates() const { return estimates_; }
  /// Diversity of the particles. Like lineages(), it is nullptr if no ancestry is stored.
  const Diversity* diversity() const { return diversity_; }
  const Lineages* lineages() const { return lineages_ ? &*lineages_ : nullptr; }

 private:
  void measure_errors(const RunRows& rows, std::size_t scans, ErrorFrame frame);
  void correct_and_whiten(const RunRows& rows, std::size_t particles, ErrorFrame frame);
  void correct_spread(std::size_t s, const std::optional<DrawsScales>& scales);
  void whiten_pose(const RunRows& rows, std::size_t s, const std::optional<DrawsScales>& scales,
                   ErrorFrame frame);

  /// {Moments} NEES by each definition of the moments.
  std::array<NeesRows, kMoments.size()> nees_;
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

}  // namespace montecarta::analysis
