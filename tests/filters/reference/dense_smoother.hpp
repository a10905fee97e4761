// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/eigen_jacobians.hpp"
#include "filters/smoothing/factor_graph.hpp"

#include <Eigen/Dense>

#include <vector>

namespace montecarta::filters::reference {

/// The maximum a posteriori estimate of a factor graph by Gauss and Newton on one dense system,
/// with additive steps in the map frame; poses first, then landmarks. Motions must have covariances
/// of full rank.
class DenseSmoother {
 public:
  DenseSmoother(const FactorGraph& graph, const Belief& belief) : graph_(graph), belief_(belief) {}

  /// Steps of Gauss and Newton, so many, from `estimate`.
  void solve(const GraphEstimate& estimate, int steps) {
    x = Eigen::VectorXd(3 * poses() + 2 * landmarks());
    for (std::size_t t = 0; t < graph_.poses(); ++t) {
      const Pose& pose = estimate.poses[t];
      x.segment<3>(row_of_pose(t)) << pose.x, pose.y, pose.heading;
    }
    for (std::size_t l = 0; l < graph_.landmarks(); ++l) {
      x.segment<2>(row_of_landmark(l)) = to_vector(estimate.landmarks[l]);
    }
    for (int step = 0; step < steps; ++step) take_step();
  }
  /// Moments of the poses `chosen` and of all landmarks.
  Eigen::MatrixXd covariance(const std::vector<std::size_t>& chosen) const {
    const Eigen::Index n = x.size();
    std::vector<Eigen::Index> rows;
    for (const std::size_t t : chosen) {
      for (const Eigen::Index i : {0, 1, 2}) rows.push_back(row_of_pose(t) + i);
    }
    for (Eigen::Index row = 3 * poses(); row < n; ++row) rows.push_back(row);
    const Eigen::MatrixXd whole =
        (J_.transpose() * J_).ldlt().solve(Eigen::MatrixXd::Identity(n, n));
    return whole(rows, rows);
  }
  Pose pose(std::size_t t) const {
    const Eigen::Vector3d v = x.segment<3>(row_of_pose(t));
    return {v(0), v(1), wrap(v(2))};
  }
  Eigen::Vector2d landmark(std::size_t l) const { return x.segment<2>(row_of_landmark(l)); }

  Eigen::VectorXd x;

 private:
  Eigen::Index poses() const { return static_cast<Eigen::Index>(graph_.poses()); }
  Eigen::Index landmarks() const { return static_cast<Eigen::Index>(graph_.landmarks()); }
  static Eigen::Index row_of_pose(std::size_t t) { return 3 * static_cast<Eigen::Index>(t); }
  Eigen::Index row_of_landmark(std::size_t l) const {
    return 3 * poses() + 2 * static_cast<Eigen::Index>(l);
  }

  void take_step() {
    std::size_t observations = 0;
    for (std::size_t t = 0; t < graph_.poses(); ++t)
      observations += graph_.observations_of(t).size();
    const Eigen::Index rows = 3 * poses() + 2 * static_cast<Eigen::Index>(observations);
    J_ = Eigen::MatrixXd::Zero(rows, x.size());
    r_ = Eigen::VectorXd::Zero(rows);
    Eigen::Index row = 0;
    for (std::size_t t = 0; t < graph_.poses(); ++t) {
      add_motion(t, row);
      row += 3;
      for (const auto& observation : graph_.observations_of(t)) {
        add_observation(t, observation, row);
        row += 2;
      }
    }
    x -= (J_.transpose() * J_).ldlt().solve(J_.transpose() * r_);
  }
  /// Displacement in the frame of the pose before, less its mean, whitened.
  void add_motion(std::size_t t, Eigen::Index row) {
    const Pose a = t == 0 ? graph_.start() : pose(t - 1), b = pose(t);
    const double c = std::cos(a.heading), s = std::sin(a.heading);
    Eigen::Matrix3d to_body;
    to_body << c, s, 0, -s, c, 0, 0, 0, 1;
    const Eigen::Vector3d d = to_body * boxminus(b, a);
    Eigen::Matrix3d by_before = -to_body;
    by_before.col(2) << d(1), -d(0), -1.0;
    const MotionIncrement& motion = graph_.motion(t);
    const auto L = symmetric(motion.covariance()).llt();
    const Eigen::Vector3d mean(motion.pose().x, motion.pose().y, motion.pose().heading);
    Eigen::Vector3d residual = d - mean;
    residual(2) = wrap(residual(2));
    r_.segment<3>(row) = L.matrixL().solve(residual);
    J_.block<3, 3>(row, row_of_pose(t)) = L.matrixL().solve(to_body);
    if (t > 0) J_.block<3, 3>(row, row_of_pose(t - 1)) = L.matrixL().solve(by_before);
  }
  void add_observation(std::size_t t, const FactorGraph::Observation& observation,
                       Eigen::Index row) {
    const Eigen::Vector2d place = landmark(observation.landmark);
    const auto at =
        linearised_detection(belief_.sensor, pose(t), Point{place.x(), place.y()}).value();
    const Eigen::Vector2d per_sigma = deviations_of(belief_.sensor, belief_).cwiseInverse();
    r_.segment<2>(row) = per_sigma.asDiagonal() *
                         models::residual(at.value, observation.observed, wraps_of(belief_.sensor));
    J_.block<2, 3>(row, row_of_pose(t)) = per_sigma.asDiagonal() * at.by_pose;
    J_.block<2, 2>(row, row_of_landmark(observation.landmark)) =
        per_sigma.asDiagonal() * at.by_landmark;
  }

  const FactorGraph& graph_;
  Belief belief_;
  Eigen::MatrixXd J_;
  Eigen::VectorXd r_;
};

}  // namespace montecarta::filters::reference
