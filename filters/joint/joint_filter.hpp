// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/joint/joint_belief.hpp"
#include "filters/moments/control_motion.hpp"
#include "filters/population/innovation_sums.hpp"

namespace montecarta::filters {

/// In which respects the filters of one joint Gaussian differ.
struct JointFilterSettings {
  Retraction retraction = Retraction::additive;
  int iterations = 0;  ///< of the linearisation, after the first
  Motion motion = Motion::linearised;
  Moments moments = Moments::map;  ///< of what it reports
  Linearisation linearisation = Linearisation::estimate;
};

/// A filter of one Gaussian over the pose and the map: EKF-SLAM and its kind (EQUATIONS 15).
class JointFilter final : public SlamFilter {
 public:
  JointFilter(const FilterSetup& setup, const JointFilterSettings& settings);

  void start(const Pose& start) override;
  void predict(const StepContext& context, const Control& control, double duration) override;
  /// Throws std::runtime_error if the likelihood of the scan is not finite.
  void update(const StepContext& context, Scan scan) override;
  PoseEstimate estimate() const override;
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override;
  std::optional<JointEstimate> joint(std::size_t landmarks) const override;

 private:
  void report_update(Scan scan);

  Belief belief_;
  Motion motion_form_;
  JointBelief joint_;
  MotionIncrement motion_;  ///< since the last scan
  bool is_at_scan_ = false;
  PoseMoments pose_at_scan_;  ///< before new landmarks were initialised
  ScanReport report_;
  MixtureInnovations<double> innovations_;  ///< of a mixture of one
};

}  // namespace montecarta::filters
