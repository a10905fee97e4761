// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/ackermann.hpp"
#include "filters/moments/evidence.hpp"
#include "filters/moments/motion_increment.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::filters {

/// All measurements (EQUATIONS 21): one motion factor and the factors of the detections of each
/// scan.
/// Pose t is that of scan t; the known start is not among them. Landmarks are numbered in the order
/// of initialisation.
class FactorGraph {
 public:
  /// An observation of a landmark from a pose.
  struct Observation {
    std::uint32_t landmark;
    Eigen::Vector2d observed;  ///< components of the detection
  };

  void start(const Pose& start);
  /// Adds a pose after the given motion from the pose before.
  void add_pose(const MotionIncrement& motion);
  /// Adds an observation from the newest pose. A new landmark must have the next number.
  void add_observation(std::uint32_t landmark, const Eigen::Vector2d& observed);

  std::size_t poses() const { return motions_.size(); }
  std::size_t landmarks() const { return first_pose_.size(); }
  const Pose& start() const { return start_; }
  const MotionIncrement& motion(std::size_t pose) const { return motions_[pose]; }
  std::span<const Observation> observations_of(std::size_t pose) const;
  /// Index of the first observation of a pose among all observations.
  std::size_t begin_of(std::size_t pose) const { return begin_[pose]; }
  const Observation& observation(std::size_t k) const { return observations_[k]; }
  /// The pose that observed the landmark first.
  std::size_t first_pose_of(std::size_t landmark) const { return first_pose_[landmark]; }

 private:
  Pose start_;
  std::vector<MotionIncrement> motions_;   ///< {pose} motion from the pose before
  std::vector<std::size_t> begin_;         ///< {pose} index of its first observation, and one more
  std::vector<Observation> observations_;  ///< observations of all poses, in order
  std::vector<std::size_t> first_pose_;    ///< {landmark} pose that observed it first
};

/// An estimate of all poses and landmarks in relative coordinates: displacements from pose to pose,
/// and landmarks in the frame of the pose that observed them first. A step in these moves all later
/// poses rigidly, whereas a step in the map frame breaks the path where a loop closes.
struct GraphEstimate {
  std::vector<Pose> displacements;  ///< {pose} displacement in the frame of the pose before
  std::vector<Point> in_frame;      ///< {landmark} [m] position in the frame of its first pose
  /// {pose} m of displacement = mean + covariance m, for all but the newest poses. The Gauss-Newton
  /// step computes it without the inverse of a covariance.
  std::vector<Eigen::Vector3d> multipliers;
  std::vector<Pose> poses;  ///< {pose} pose in the map frame
  /// {pose} direction of the heading of the pose before.
  std::vector<Direction<double>> directions;
  std::vector<Point> landmarks;  ///< {landmark} [m] position in the map frame

  void clear();
  /// These functions add the newest pose, and a landmark that it observed first, given in the map
  /// frame.
  void add_pose(const FactorGraph& graph, const Pose& pose);
  void add_landmark(const Point& landmark);
  /// Computes poses and landmarks in the map frame from the relative coordinates.
  void compose(const FactorGraph& graph);
};

}  // namespace montecarta::filters
