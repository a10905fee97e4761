// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/map_moments.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/smoothing/factor_graph.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <vector>

namespace montecarta::filters {

/// Where a linearisation of the graph has its least sum of squares, in the coordinates of a
/// GraphEstimate.
struct GraphMinimum {
  std::vector<Pose> displacements;           ///< {pose}
  std::vector<Eigen::Vector3d> multipliers;  ///< {pose}
  std::vector<Point> in_frame;               ///< {landmark} [m]
  double squares = 0.0;                      ///< the sum there, as linearised
};

/// One linearisation of a factor graph (EQUATIONS 21). Poses are eliminated one after the other, in
/// the form x = g + G l + N(0, C) of a pose given all landmarks l: a motion adds to C, an
/// observation adds two rows to the information of l. So a motion may be certain in some direction
/// or all, and a pose known exactly. The newest pose comes last: with the landmarks it is what
/// remains.
class Elimination {
 public:
  explicit Elimination(const SensorNoise& noise) : noise_(noise) {}

  /// Linearises at `estimate`; false where that leaves landmarks undetermined.
  [[nodiscard]] bool linearise(const FactorGraph& graph, const GraphEstimate& estimate);
  /// The least of the last linearisation, which was at `estimate`.
  void minimise(const FactorGraph& graph, const GraphEstimate& estimate, GraphMinimum& minimum);
  /// Its covariance of the newest pose and the map, in the map frame; writes no means.
  void covariance(Eigen::Matrix3d& pose, MapMoments& map) const;

 private:
  /// A motion: x = x_before + way e_heading of x_before + offset + noise, in the map frame.
  struct LinearMotion {
    Eigen::Vector2d way;     ///< [m/rad]
    Eigen::Vector3d offset;  ///< of the mean from the estimate
  };
  /// An observation in units of its innovation's standard deviations, given the landmarks.
  struct LinearObservation {
    Matrix23 pose;
    Eigen::Matrix2d landmark;
    Eigen::Vector2d residual;
    Matrix32 gain;
    Eigen::Vector2d innovation;  ///< with the landmarks where the sum is least
  };

  void begin(const FactorGraph& graph);
  void carry(const MotionIncrement& motion, const Pose& before, const Pose& after);
  void condition(const FactorGraph::Observation& observation, const Pose& pose,
                 const Point& landmark);
  void add_rows(const LinearObservation& seen, Eigen::Index row);
  void flush();
  void filter_poses(const FactorGraph& graph);
  void smooth_poses(const FactorGraph& graph, const GraphEstimate& estimate,
                    GraphMinimum& minimum) const;
  void place_landmarks(const FactorGraph& graph, const GraphEstimate& estimate,
                       GraphMinimum& minimum);

  SensorNoise noise_;
  std::vector<LinearMotion> motions_;            ///< {pose}
  std::vector<LinearObservation> observations_;  ///< of all poses
  Eigen::Index rows_ = 0;                        ///< used: 2, and 2 for each landmark seen so far
  Eigen::Index height_ = 0;                      ///< rows of all landmarks, in packs
  Eigen::Matrix<double, Eigen::Dynamic, 3> given_;  ///< row 0: g; from 2 on: G'
  Eigen::Matrix3d covariance_;                      ///< C
  Eigen::MatrixXd information_;  ///< of (1, 0, l): the sum of squares as a form; lower triangle
  Eigen::MatrixXd panel_;    ///< rows of observations that are not in information_ yet, transposed
  Eigen::Index filled_ = 0;  ///< of its columns
  Eigen::LLT<Eigen::MatrixXd> factor_;  ///< of the information of l
  Eigen::VectorXd step_;                ///< of l, where the sum is least
};

}  // namespace montecarta::filters
