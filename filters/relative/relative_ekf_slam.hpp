// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/association/map_association.hpp"
#include "filters/moments/control_motion.hpp"
#include "filters/relative/relative_gaussian.hpp"
#include "filters/setup/filter_kind.hpp"

#include <optional>
#include <vector>

namespace montecarta::filters {

/// EKF-SLAM in relative coordinates (EQUATIONS 22): a joint Gaussian of the displacements between
/// the poses that initialised landmarks, and of the landmarks in the frames of these poses. In
/// these coordinates the posterior is nearly Gaussian even if the heading in the map is uncertain.
/// All other poses are integrated out, and a scan is linearised only when it is conditioned on.
class RelativeEkfSlam final : public SlamFilter {
 public:
  explicit RelativeEkfSlam(const FilterSetup& setup);

  void start(const Pose& start) override;
  void predict(const StepContext& context, const Control& control, double duration) override;
  void update(const StepContext& context, Scan scan) override;
  PoseEstimate estimate() const override;
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override;
  std::optional<JointEstimate> joint(std::size_t landmarks) const override;

 private:
  void pair_nearest(Scan scan);
  void condition(Scan scan);
  bool is_bent(std::size_t landmark) const;
  void initialise_landmarks(Scan scan);
  void merge_duplicates();
  const RelativeGaussian& reported() const {
    return gaussian_.has_duplicates() ? joined_ : gaussian_;
  }
  JointEstimate moments_of(const RelativeGaussian& gaussian) const;
  JointEstimate held_joint() const;

  Belief model_;
  Motion motion_kind_;
  std::size_t most_frames_;
  int iterations_;
  double most_bend_;  ///< [m]
  std::size_t lag_;   ///< [scans]
  MapAssociation association_;
  MotionIncrement motion_;  ///< since the last scan
  bool is_at_scan_ = true;  ///< true if no motion followed
  RelativeGaussian gaussian_;
  RelativeGaussian joined_;  ///< a copy with the landmarks joined that were initialised again
  std::size_t waited_ = 0;   ///< [scans] since the first of them
  std::vector<RelativeGaussian::Seen>
      duplicates_;                            ///< detections of landmarks to be initialised again
  std::vector<double> bends_;                 ///< {frame} RelativeGaussian::bends()
  std::vector<RelativeGaussian::Seen> seen_;  ///< detections to be used
  std::vector<NearestSearch> searches_;       ///< scratch, like the next three
  mutable RelativeGaussian moved_;
  mutable ChainMoments moments_;
  mutable std::vector<RelativeChain::Point> points_;
  ScanReport report_;
};

/// Line for the table of filters.
FilterKind relative_ekf_slam_kind();

}  // namespace montecarta::filters
