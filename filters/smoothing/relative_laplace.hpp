// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/relative/chain_moments.hpp"
#include "filters/smoothing/poses_given_map.hpp"

#include <Eigen/SparseCore>

#include <vector>

namespace montecarta::filters {

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
