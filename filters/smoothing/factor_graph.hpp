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

/// What earlier measurements say about the start of a graph and about landmarks, after their poses
/// were marginalised (EQUATIONS (25.1)): given the landmarks, the start is Gaussian, and of the
/// landmarks there is information. All is linear in the way from an estimate, with the rows of an
/// Elimination.
struct GraphPrior {
  Pose start;                    ///< estimate of the start
  std::vector<Point> landmarks;  ///< {landmark} [m] estimates
  std::vector<Point> first;      ///< {landmark} [m] estimates when the prior first had them
  Eigen::Matrix<double, Eigen::Dynamic, 3> given;  ///< form of the start
  Eigen::Matrix3d covariance;                      ///< covariance of the start, given the landmarks
  Eigen::MatrixXd information;  ///< quadratic form of (1, 0, landmarks); lower triangle

  /// Starts at a known pose, without landmarks.
  void clear(const Pose& known);
  /// Way [m] of the landmarks from their estimates here, with rows as in `given`.
  Eigen::VectorXd way_to(std::span<const Point> landmarks) const;
  /// The sum of squares of the prior, with the start as far from its mean as `multiplier` says and
  /// the landmarks at `landmarks` [m].
  double squares(const Eigen::Vector3d& multiplier, std::span<const Point> landmarks) const;
};

/// All measurements (EQUATIONS 21): one motion factor and the factors of the detections of each
/// scan, after a known start or a prior.
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

  /// Drops the first pose with its motion and its observations, which `prior` contains, as it does
  /// the motion to the next pose. The first pose of the graph is then the start of the prior.
  void replace_first_pose(const GraphPrior& prior);

  std::size_t poses() const { return motions_.size(); }
  std::size_t landmarks() const { return first_pose_.size(); }
  const Pose& start() const { return prior_.start; }
  const GraphPrior& prior() const { return prior_; }
  /// Returns whether the graph begins with a prior, else with a known start.
  bool has_prior() const { return prior_.given.rows() > 0; }
  const MotionIncrement& motion(std::size_t pose) const { return motions_[pose]; }
  std::span<const Observation> observations_of(std::size_t pose) const;
  /// Index of the first observation of a pose among all observations.
  std::size_t begin_of(std::size_t pose) const { return begin_[pose]; }
  const Observation& observation(std::size_t k) const { return observations_[k]; }
  /// The pose that observed the landmark first; 0 for a landmark of the prior.
  std::size_t first_pose_of(std::size_t landmark) const { return first_pose_[landmark]; }

 private:
  GraphPrior prior_;
  std::vector<MotionIncrement> motions_;   ///< {pose} motion from the pose before
  std::vector<std::size_t> begin_;         ///< {pose} index of its first observation, and one more
  std::vector<Observation> observations_;  ///< observations of all poses, in order
  std::vector<std::size_t> first_pose_;    ///< {landmark} pose that observed it first
};

/// An estimate of all poses and landmarks in relative coordinates: displacements from pose to pose,
/// and landmarks in the frame of the pose that observed them first. A step in these moves all later
/// poses rigidly, whereas a step in the map frame breaks the path where a loop closes. The start
/// and the landmarks of a prior, which is linear in the map frame, are in the map frame.
struct GraphEstimate {
  Pose start;
  /// m of start = mean by the prior, given the landmarks, + covariance m.
  Eigen::Vector3d start_multiplier = Eigen::Vector3d::Zero();
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
  /// Moves the newest pose.
  void move_newest(const Pose& pose);
  /// Does what graph.replace_first_pose() has done to the graph.
  void replace_first_pose(const FactorGraph& graph);
  /// Computes poses and landmarks in the map frame from the relative coordinates.
  void compose(const FactorGraph& graph);
};

}  // namespace montecarta::filters
