// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/relative/relative_chain.hpp"
#include "filters/smoothing/elimination.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <span>
#include <vector>

namespace montecarta::filters {

/// First row of the i-th pose.
inline Eigen::Index row_of_pose(std::size_t i) { return 3 * static_cast<Eigen::Index>(i); }

/// Covariance of some poses and all landmarks, given all measurements (EQUATIONS (21.8), (21.9)).
/// Given the landmarks, the last poses of segments are a Markov chain.
class PosesGivenMap {
 public:
  /// Covariance, in the map frame, of the last poses of the segments `chosen`, in order, with three
  /// rows [m, m, rad] each, and of all landmarks, with two rows [m] each.
  Eigen::MatrixXd covariance(const Elimination& elimination, std::span<const std::size_t> chosen);

 private:
  using Rows = Segment::Rows;

  /// The last pose of a segment, given the pose before it, the landmarks and all measurements: x =
  /// transition x_before + by_landmarks' l + N(0, covariance), up to a constant.
  struct LaplaceStep {
    Eigen::Matrix3d transition;
    Eigen::Matrix3d covariance;
    Rows by_landmarks;  ///< {row of l, 3} derivatives by the landmarks
  };

  void step_backwards(const Elimination& elimination, Eigen::Index rows);

  std::vector<LaplaceStep> steps_;  ///< {segment} step to the last pose of the segment
  MapMoments map_;
};

/// Moments in the map frame of the newest pose and all landmarks, with a posterior that is Gaussian
/// in relative coordinates (EQUATIONS 21): the displacements between the last poses of segments,
/// and each landmark in range and bearing of one of these poses, or, if it is too near for that, by
/// its position in that frame.
class RelativeLaplace {
 public:
  /// Moments at `estimate`, which has the least sum of squares; `elimination` was linearised there
  /// or one last step before. The graph must have a landmark, and defines their order.
  JointEstimate of(const FactorGraph& graph, const GraphEstimate& estimate,
                   const Elimination& elimination);

 private:
  void choose_frames(const FactorGraph& graph, const Elimination& elimination);
  void add_displacement(const FactorGraph& graph, const GraphEstimate& estimate, std::size_t frame);
  void add_landmark(const FactorGraph& graph, const GraphEstimate& estimate,
                    const Eigen::MatrixXd& P, std::size_t landmark);
  void add_derivative(Eigen::Index row, Eigen::Index column, const Eigen::MatrixXd& block);

  std::vector<std::size_t> ends_;    ///< segments that end in a frame, then that of the newest pose
  std::vector<std::size_t> frames_;  ///< poses of the frames
  std::size_t newest_ = 0;           ///< index of the newest pose
  RelativeChain chain_;
  std::vector<RelativeChain::Point> points_;  ///< {landmark} coordinates of the landmark
  Eigen::VectorXd mean_;
  std::vector<Eigen::Triplet<double>> by_map_;  ///< derivatives of the coordinates by poses and map
  PosesGivenMap poses_given_map_;
  ChainMoments moments_;
};

}  // namespace montecarta::filters
