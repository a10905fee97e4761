// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/textbook_ekf_slam.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::filters::reference {

/// Robocentric EKF-SLAM with full matrices, known association, as Castellanos, Martinez-Cantin,
/// Tardos and Neira 2007 have it. The state is (base, motion, landmarks), all in the frame of the
/// vehicle at the scan before: the pose of the map's frame, that of the vehicle, points. Detections
/// correct all of it, then it is composed into the frame of the vehicle now.
class RobocentricEkfSlam {
 public:
  explicit RobocentricEkfSlam(const Belief& belief) : belief_(belief) {}

  void start(const Pose& start) {
    start_ = start;
    state_ = Eigen::VectorXd::Zero(6);
    P_ = Eigen::MatrixXd::Zero(6, 6);
    identities_.clear();
  }

  void predict(const Control& control, double duration) {
    const Pose motion{state_(3), state_(4), state_(5)};
    const auto step = linearised_move(motion, control, duration, belief_.vehicle);
    Eigen::MatrixXd F = Eigen::MatrixXd::Identity(state_.size(), state_.size());
    F.block<3, 3>(3, 3) = pose_jacobian(step.jacobians);
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(state_.size(), 2);
    G.middleRows<3>(3) = control_jacobian(step.jacobians);
    const Eigen::Vector2d Q(std::pow(belief_.control.sigma[0], 2),
                            std::pow(belief_.control.sigma[1], 2));
    state_.segment<3>(3) << step.pose.x, step.pose.y, step.pose.heading;
    P_ = sandwich(F, P_) + sandwich(G, Q.asDiagonal());
  }

  void update(Scan scan) {
    std::vector<Detection> fresh;
    for (const Detection& detection : scan) {
      const auto slot = std::ranges::find(identities_, detection.identity) - identities_.begin();
      if (slot == std::ssize(identities_)) {
        fresh.push_back(detection);
      } else {
        update_with(detection, 6 + 2 * slot);
      }
    }
    compose();
    for (const Detection& detection : fresh) append(detection);
  }

  /// In the map: start (+) (base^-1 (+) motion).
  PoseMoments pose() const {
    const Eigen::Matrix2d B = rotation(-state_(2)), W = rotation(start_.heading);
    const Eigen::Vector2d way = B * (state_.segment<2>(3) - state_.head<2>());
    const Eigen::Vector2d place = Eigen::Vector2d(start_.x, start_.y) + W * way;
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(3, state_.size());
    T.block<2, 2>(0, 0) = -W * B;
    T.block<2, 1>(0, 2) = W * Eigen::Vector2d(way.y(), -way.x());
    T.block<2, 2>(0, 3) = W * B;
    T(2, 2) = -1.0;
    T(2, 5) = 1.0;
    return {{place.x(), place.y(), wrap(start_.heading + state_(5) - state_(2))}, sandwich(T, P_)};
  }

 private:
  static Eigen::Matrix2d rotation(double angle) {
    return Eigen::Matrix2d{{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}};
  }
  Eigen::Matrix2d R() const {
    return Eigen::Vector2d(std::pow(belief_.sigma_range, 2), std::pow(belief_.sigma_bearing, 2))
        .asDiagonal();
  }
  void update_with(const Detection& detection, Eigen::Index row) {
    const auto at = linearised_observation(Pose{state_(3), state_(4), state_(5)},
                                           Point{state_(row), state_(row + 1)});
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, state_.size());
    H.middleCols<3>(3) = pose_jacobian(at);
    H.middleCols<2>(row) = landmark_jacobian(at);
    const Eigen::Matrix2d S = sandwich(H, P_) + R();
    const Eigen::MatrixXd K =
        product(product(P_, H.transpose()), S.ldlt().solve(Eigen::Matrix2d::Identity()).eval());
    state_ += product(K, to_vector(residual(observation_of(detection), at.observation)));
    const Eigen::MatrixXd I_KH =
        Eigen::MatrixXd::Identity(state_.size(), state_.size()) - product(K, H);
    P_ = sandwich(I_KH, P_) + sandwich(K, R());
  }
  /// (-) motion (+) everything, linearised at the corrected motion.
  void compose() {
    const Eigen::Matrix2d back = rotation(-state_(5));
    const Eigen::Vector2d moved = state_.segment<2>(3);
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(state_.size(), state_.size());
    const auto carry = [&](Eigen::Index row) {
      const Eigen::Vector2d now = back * (state_.segment<2>(row) - moved);
      state_.segment<2>(row) = now;
      T.block<2, 2>(row, row) = back;
      T.block<2, 2>(row, 3) = -back;
      T.block<2, 1>(row, 5) = Eigen::Vector2d(now.y(), -now.x());
    };
    carry(0);
    T(2, 2) = 1.0;
    T(2, 5) = -1.0;
    state_(2) = wrap(state_(2) - state_(5));
    for (Eigen::Index row = 6; row < state_.size(); row += 2) carry(row);
    state_.segment<3>(3).setZero();
    P_ = sandwich(T, P_);
  }
  void append(const Detection& detection) {
    const auto placed = linearised_place(Pose{}, observation_of(detection));
    const Eigen::Matrix2d Gz = observation_jacobian(placed);
    const Eigen::Index n = state_.size();
    state_.conservativeResize(n + 2);
    state_.tail<2>() = to_vector(placed.point);
    Eigen::MatrixXd grown = Eigen::MatrixXd::Zero(n + 2, n + 2);
    grown.topLeftCorner(n, n) = P_;
    grown.bottomRightCorner<2, 2>() = Gz * R() * Gz.transpose();
    P_ = grown;
    identities_.push_back(detection.identity);
  }

  Belief belief_;
  Pose start_;
  Eigen::VectorXd state_;
  Eigen::MatrixXd P_;
  std::vector<std::int32_t> identities_;
};

}  // namespace montecarta::filters::reference
