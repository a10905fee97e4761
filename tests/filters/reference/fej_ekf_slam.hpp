// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/textbook_ekf_slam.hpp"

#include <vector>

namespace montecarta::filters::reference {

/// EKF-SLAM by first estimates with full matrices at every step, known association, as Huang,
/// Mourikis and Roumeliotis 2008 have it: propagation by the predicted place before the last
/// update, observations by that of the scan and the landmark as it was initialised. `constrained`:
/// as they have it in 2010, with p* = p + lambda / (m + 1) before a motion, lambda = sum of
/// (landmark - its first estimate - (p - p predicted + sum of all p* - p predicted before)).
class FejEkfSlam {
 public:
  FejEkfSlam(const Belief& belief, bool constrained) : belief_(belief), constrained_(constrained) {}

  void start(const Pose& start) {
    mean.resize(3);
    mean << start.x, start.y, start.heading;
    covariance = Eigen::MatrixXd::Zero(3, 3);
    predicted_ = mean.head<2>();
    moved_.setZero();
    identities_.clear();
    first_.clear();
  }

  void predict(const Control& control, double duration) {
    const auto step = linearised_move(pose(), control, duration, belief_.vehicle);
    if (is_updated_) choose_origin();
    const Eigen::Vector2d way = Eigen::Vector2d(step.pose.x, step.pose.y) - predicted_;
    Eigen::MatrixXd F = Eigen::MatrixXd::Identity(mean.size(), mean.size());
    F.block<2, 1>(0, 2) << -way.y(), way.x();
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(mean.size(), 2);
    G.topRows<3>() = control_jacobian(step.jacobians);
    const Eigen::Vector2d Q(std::pow(belief_.control.sigma[0], 2),
                            std::pow(belief_.control.sigma[1], 2));
    mean.head<3>() << step.pose.x, step.pose.y, step.pose.heading;
    covariance = sandwich(F, covariance) + sandwich(G, Q.asDiagonal());
    predicted_ = mean.head<2>();
  }

  void update(Scan scan) {
    const double heading = mean(2);
    std::vector<Detection> fresh;
    for (const Detection& detection : scan) {
      const auto slot = static_cast<std::size_t>(
          std::ranges::find(identities_, detection.identity) - identities_.begin());
      if (slot == identities_.size()) {
        fresh.push_back(detection);
      } else {
        update_with(detection, slot, heading);
      }
    }
    for (const Detection& detection : fresh) append(detection);
    is_updated_ = true;
  }

  Pose pose() const { return {mean(0), mean(1), mean(2)}; }

  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;

 private:
  Eigen::Matrix2d R() const {
    return Eigen::Vector2d(std::pow(belief_.sigma_range, 2), std::pow(belief_.sigma_bearing, 2))
        .asDiagonal();
  }
  Eigen::Vector2d landmark(std::size_t slot) const {
    return mean.segment<2>(3 + 2 * static_cast<Eigen::Index>(slot));
  }
  /// Where the next propagation begins: p*.
  void choose_origin() {
    is_updated_ = false;
    if (!constrained_) return;
    const Eigen::Vector2d correction = mean.head<2>() - predicted_;
    Eigen::Vector2d lambda = Eigen::Vector2d::Zero();
    for (std::size_t slot = 0; slot < first_.size(); ++slot) {
      lambda += landmark(slot) - first_[slot] - (correction + moved_);
    }
    const Eigen::Vector2d origin = mean.head<2>() + lambda / static_cast<double>(first_.size() + 1);
    moved_ += origin - predicted_;
    predicted_ = origin;
  }
  void update_with(const Detection& detection, std::size_t slot, double heading) {
    const Eigen::Vector2d place = first_[slot] + moved_, now = landmark(slot);
    const auto at = linearised_observation(Pose{predicted_.x(), predicted_.y(), heading},
                                           Point{place.x(), place.y()});
    const auto expected = linearised_observation(pose(), Point{now.x(), now.y()}).observation;
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, mean.size());
    H.leftCols<3>() = pose_jacobian(at);
    H.middleCols<2>(3 + 2 * static_cast<Eigen::Index>(slot)) = landmark_jacobian(at);
    const Eigen::Matrix2d S = sandwich(H, covariance) + R();
    const Eigen::Matrix2d per_S = S.ldlt().solve(Eigen::Matrix2d::Identity());
    const Eigen::MatrixXd K = product(product(covariance, H.transpose()), per_S);
    mean += product(K, to_vector(residual(observation_of(detection), expected)));
    mean(2) = wrap(mean(2));
    const Eigen::MatrixXd I_KH =
        Eigen::MatrixXd::Identity(mean.size(), mean.size()) - product(K, H);
    covariance = sandwich(I_KH, covariance) + sandwich(K, R());
  }
  /// Derivative by the heading: from the predicted place, as an observation of it would have.
  void append(const Detection& detection) {
    const auto placed = linearised_place(pose(), observation_of(detection));
    const Eigen::Matrix2d Gz = observation_jacobian(placed);
    const Eigen::Vector2d place = to_vector(placed.point), away = place - predicted_;
    const Eigen::Index n = mean.size();
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n + 2, n);
    G.topRows(n).setIdentity();
    G.bottomLeftCorner<2, 3>() << 1.0, 0.0, -away.y(), 0.0, 1.0, away.x();
    Eigen::MatrixXd grown = sandwich(G, covariance);
    grown.bottomRightCorner<2, 2>() += Gz * R() * Gz.transpose();
    covariance = grown;
    mean.conservativeResize(n + 2);
    mean.tail<2>() = place;
    identities_.push_back(detection.identity);
    first_.emplace_back(place - moved_);
  }

  Belief belief_;
  bool constrained_;
  bool is_updated_ = false;
  Eigen::Vector2d predicted_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d moved_ = Eigen::Vector2d::Zero();  ///< sum of p* - p predicted
  std::vector<std::int32_t> identities_;
  std::vector<Eigen::Vector2d> first_;  ///< as initialised, less what had moved then
};

}  // namespace montecarta::filters::reference
