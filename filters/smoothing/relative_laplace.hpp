// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/relative/relative_chain.hpp"
#include "filters/smoothing/elimination.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <span>
#include <vector>

namespace montecarta::filters {

/// First row of the i-th of some poses.
inline Eigen::Index row_of_pose(std::size_t i) { return 3 * static_cast<Eigen::Index>(i); }

/// Covariance of some poses and all landmarks, by all that was measured (EQUATIONS (21.8),
/// (21.9)): given the landmarks, the last poses of segments are a Markov chain.
class PosesGivenMap {
 public:
  /// Of the last poses of the segments `chosen`, in order, three rows [m, m, rad] each, and of the
  /// landmarks, two rows [m] each, in the map frame.
  Eigen::MatrixXd covariance(const Elimination& elimination, std::span<const std::size_t> chosen);

 private:
  using Rows = Segment::Rows;

  /// The last pose of a segment, given the pose before it, the landmarks and all that was measured:
  /// x = transition x_before + by_landmarks' l + N(0, covariance), but for a constant.
  struct Step {
    Eigen::Matrix3d transition;
    Eigen::Matrix3d covariance;
    Rows by_landmarks;  ///< {row of l, 3}
  };

  void step_backwards(const Elimination& elimination, Eigen::Index rows);

  std::vector<Step> steps_;  ///< {segment}
  MapMoments map_;
};

/// Moments in the map frame of the newest pose and all landmarks, whose posterior is taken for a
/// Gaussian in relative coordinates (EQUATIONS 21): of the displacements between the last poses of
/// segments, and of each landmark in range and bearing of one of these, or where it is too near for
/// that in its frame.
class RelativeLaplace {
 public:
  /// At `estimate`, which has the least sum of squares; the graph, with at least one landmark, was
  /// linearised there or one last step before. The landmarks in the order of the graph.
  JointEstimate of(const FactorGraph& graph, const GraphEstimate& estimate,
                   const Elimination& elimination);

 private:
  void choose_frames(const FactorGraph& graph, const Elimination& elimination);
  void add_displacement(const FactorGraph& graph, const GraphEstimate& estimate, std::size_t frame);
  void add_landmark(const FactorGraph& graph, const GraphEstimate& estimate,
                    const Eigen::MatrixXd& P, std::size_t landmark);
  void add_derivative(Eigen::Index row, Eigen::Index column, const Eigen::MatrixXd& block);

  std::vector<std::size_t> ends_;    ///< segments: of the frames, then of the newest pose
  std::vector<std::size_t> frames_;  ///< their poses
  std::size_t newest_ = 0;           ///< pose
  RelativeChain chain_;
  std::vector<RelativeChain::Point> points_;  ///< {landmark}
  Eigen::VectorXd mean_;
  std::vector<Eigen::Triplet<double>> by_map_;  ///< derivatives of the coordinates
  PosesGivenMap poses_given_map_;
  ChainMoments moments_;
};

}  // namespace montecarta::filters
