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

/// All that was measured (EQUATIONS 21): one motion factor and the range-bearing factors of each
/// scan. Pose t is that of scan t, the known start is none of them; landmarks are numbered in the
/// order in which they were initialised.
class FactorGraph {
 public:
  /// Landmark `landmark` seen from a pose.
  struct Observation {
    std::uint32_t landmark;
    RangeBearing<double> observed;
  };

  void start(const Pose& start);
  /// The vehicle moved by `motion` since the pose before.
  void add_pose(const MotionIncrement& motion);
  /// The newest pose sees a landmark; one that is new has the next number.
  void add_observation(std::uint32_t landmark, const RangeBearing<double>& observed);

  std::size_t poses() const { return motions_.size(); }
  std::size_t landmarks() const { return first_pose_.size(); }
  const Pose& start() const { return start_; }
  const MotionIncrement& motion(std::size_t pose) const { return motions_[pose]; }
  std::span<const Observation> observations_of(std::size_t pose) const;
  /// Which of all observations the first of a pose is.
  std::size_t begin_of(std::size_t pose) const { return begin_[pose]; }
  const Observation& observation(std::size_t k) const { return observations_[k]; }
  /// The pose that saw it first.
  std::size_t first_pose_of(std::size_t landmark) const { return first_pose_[landmark]; }

 private:
  Pose start_;
  std::vector<MotionIncrement> motions_;   ///< {pose}
  std::vector<std::size_t> begin_;         ///< {pose} and one more
  std::vector<Observation> observations_;  ///< of all poses, one after the other
  std::vector<std::size_t> first_pose_;    ///< {landmark}
};

/// An estimate of all poses and landmarks, in relative coordinates: displacements from pose to pose
/// and landmarks in the frame of the pose that saw them first. A step in these turns rigidly what
/// comes behind it; a step in the map frame does not keep the path continuous where a loop closes.
struct GraphEstimate {
  std::vector<Pose> displacements;  ///< {pose} in the frame of the pose before
  std::vector<Point> in_frame;      ///< {landmark} in that of its first pose [m]
  /// {pose} m of displacement = mean + covariance m, of all but the newest poses: the step of
  /// Gauss and Newton gives it, and no covariance needs to be inverted.
  std::vector<Eigen::Vector3d> multipliers;
  std::vector<Pose> poses;  ///< {pose} in the map frame
  /// {pose} of the heading of the pose before.
  std::vector<Direction<double>> directions;
  std::vector<Point> landmarks;  ///< {landmark} likewise [m]

  void clear();
  /// Adds the newest pose and the landmarks that it saw first, given in the map frame.
  void add_pose(const FactorGraph& graph, const Pose& pose);
  void add_landmark(const Point& landmark);
  /// Poses and landmarks in the map frame, of those in relative coordinates.
  void compose(const FactorGraph& graph);
};

}  // namespace montecarta::filters
