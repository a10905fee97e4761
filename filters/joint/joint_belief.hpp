// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/association/map_association.hpp"
#include "filters/joint/delayed_initialisation.hpp"
#include "filters/joint/linearisation.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::filters {

/// Returns whether a rotation of vehicle and map changes no detection, so that detections have no
/// information about it, and whether a JointBelief can compute what it nevertheless assumes.
bool has_rotation_information(const FilterSetup& setup);

/// A joint Gaussian over pose and map with the association of its detections. Detections are used
/// one by one in the order of the scan.
class JointBelief {
 public:
  /// `iterations` is that of CompressedGaussian::update_with(); `moments` applies to all reports.
  JointBelief(const FilterSetup& setup, Retraction retraction, int iterations,
              Moments moments = Moments::map,
              std::unique_ptr<Linearisation> linearisation = at_estimate());

  /// Starts from what is known of the pose and of the map.
  void start(const Prior& prior);
  /// Predicts by `motion`, conditions the Gaussian on the fix of the position if there is one,
  /// associates the scan, and conditions the Gaussian on the matched detections.
  void update_with(const MotionIncrement& motion, Scan scan,
                   const std::optional<PositionFix>& fix = {});
  /// Initialises the landmarks that the scan of the last update_with() shows for the first time. If
  /// one detection does not fix a landmark, advances its DelayedInitialisation instead. Throws
  /// RunError if the map has grown beyond its limit.
  void initialise_landmarks(Scan scan);
  void replace(const PoseMoments& pose, const MapMoments& map) {
    system_.gaussian.replace(pose, map);
  }

  const CompressedGaussian& gaussian() const { return system_.gaussian; }
  /// Predicted moments of the pose after `motion`.
  PoseMoments pose_after(const MotionIncrement& motion) const;
  /// Number of landmarks in the map.
  std::size_t landmarks() const { return point_of_.size(); }
  /// Returns landmark k: the one of identity k with known association, else the k-th initialised.
  std::optional<LandmarkEstimate> landmark(std::size_t k) const;
  /// Pose and landmarks 0 to `landmarks` - 1; NaN for landmarks that the map does not have.
  JointEstimate joint(std::size_t landmarks) const;

  /// Results of the last scan.
  struct UpdateOutcome {
    double log_likelihood = 0.0;
    std::uint32_t faults = 0;
  };
  const UpdateOutcome& outcome() const { return outcome_; }
  const MapAssociation& association() const { return association_; }
  /// Information [1/rad^2] about a rotation of vehicle and map that the linearised system gains
  /// from all detections since the start, though they have none (EQUATIONS (15.11)). It is empty
  /// if has_rotation_information() is false.
  std::span<const double> rotation_information() const {
    return {&rotation_information_, has_rotation_information_ ? 1U : 0U};
  }
  /// A detection that updated the belief.
  struct UsedDetection {
    std::size_t detection;  ///< index of the detection in the scan
    Eigen::Vector2d innovation;
    Eigen::Matrix2d covariance;  ///< S = H P H' + R
  };
  std::span<const UsedDetection> used_detections() const { return used_detections_; }

 private:
  ObservationPoint rotation_point(std::size_t slot) const;
  double reach_of(Scan scan) const;
  void pair_nearest(Scan scan);
  void select_matched();
  bool predict(std::size_t slot, ExpectedObservation& expected);
  void update_with(const PositionFix& fix);
  void update_with(std::size_t k, const Detection& detection);

  void find_advancing(Scan scan);
  void add_known(const LandmarkEstimate& known);
  void add_landmark(std::int32_t identity, std::uint32_t point);
  void place_landmark(const Detection& fresh);

  Sensor sensor_;
  MapAssociation association_;
  std::unique_ptr<Linearisation> linearisation_;
  LinearisedSystem system_;              ///< its points are used if the sensor fixes landmarks
  std::vector<std::uint32_t> point_of_;  ///< {landmark} slot of the landmark in the Gaussian
  DelayedInitialisation delayed_;
  std::vector<char> advancing_;  ///< scratch: {detection} whether it advances a landmark
  int iterations_;
  Moments moments_;
  Retraction retraction_;
  Eigen::Vector2d sigma_;            ///< deviations of the components of a detection
  std::optional<double> sigma_fix_;  ///< [m] deviation of a fix of the position
  bool has_rotation_information_;
  double rotation_information_ = 0.0;
  std::vector<NearestSearch> searches_;  ///< scratch: {detection} searches of a scan
  std::vector<std::uint32_t> matched_;   ///< scratch: slots that the current scan needs
  std::vector<UsedDetection> used_detections_;
  UpdateOutcome outcome_;
};

}  // namespace montecarta::filters
