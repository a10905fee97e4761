// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/factory.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/setup/filter_setup.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <vector>

/// A Kalman filter with full matrices at every step and known association, as its paper has it.
namespace montecarta::filters::reference {

/// A B and A P A' of full matrices; every size alike, which spares the compiler most of its work.
inline Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) { return A * B; }
inline Eigen::MatrixXd sandwich(const Eigen::MatrixXd& A, const Eigen::MatrixXd& P) {
  return product(product(A, P), A.transpose());
}

/// A Gaussian over `rows_before` rows, then landmarks in the order of their initialisation.
class FullGaussian {
 public:
  FullGaussian(const Belief& belief, Eigen::Index rows_before)
      : belief_(belief), rows_before_(rows_before) {}

  /// First of the two rows of a landmark, -1 where it is not in the map.
  Eigen::Index row_of(std::int32_t identity) const {
    const auto slot = std::ranges::find(identities_, identity) - identities_.begin();
    return slot == std::ssize(identities_) ? -1 : rows_before_ + 2 * slot;
  }

  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;

 protected:
  void start(const Eigen::VectorXd& at) {
    mean = at;
    covariance = Eigen::MatrixXd::Zero(at.size(), at.size());
    identities_.clear();
  }
  const Belief& belief() const { return belief_; }
  Eigen::Matrix2d R() const {
    return Eigen::Vector2d(std::pow(belief_.sigma_range, 2), std::pow(belief_.sigma_bearing, 2))
        .asDiagonal();
  }
  Eigen::Vector2d Q() const {
    return {std::pow(belief_.control.sigma[0], 2), std::pow(belief_.control.sigma[1], 2)};
  }
  Pose pose_at(Eigen::Index row) const { return {mean(row), mean(row + 1), mean(row + 2)}; }
  Point point_at(Eigen::Index row) const { return {mean(row), mean(row + 1)}; }

  /// The pose of three rows moves to `there`.
  void move(Eigen::Index row, const Pose& there, const Eigen::Matrix3d& by_pose,
            const Eigen::Matrix<double, 3, 2>& by_control) {
    mean.segment<3>(row) << there.x, there.y, there.heading;
    covariance.middleRows<3>(row) = product(by_pose, covariance.middleRows<3>(row));
    covariance.middleCols<3>(row) = product(covariance.middleCols<3>(row), by_pose.transpose());
    covariance.block<3, 3>(row, row) += sandwich(by_control, Q().asDiagonal());
  }
  /// Calls `see(detection, row)` for landmarks in the map, then append(detection, place) for the
  /// others.
  template <class See, class Place>
  void use(Scan scan, const See& see, const Place& place) {
    std::vector<Detection> fresh;
    for (const Detection& detection : scan) {
      const Eigen::Index row = row_of(detection.identity);
      row < 0 ? fresh.push_back(detection) : see(detection, row);
    }
    for (const Detection& detection : fresh) place(detection);
  }
  /// Derivative of an observation by the rows of a pose and of a landmark.
  Eigen::MatrixXd derivative(Eigen::Index pose, Eigen::Index landmark,
                             const LinearisedObservation<double>& at) const {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, mean.size());
    H.middleCols<3>(pose) = pose_jacobian(at);
    H.middleCols<2>(landmark) = landmark_jacobian(at);
    return H;
  }
  /// Kalman's step, and Joseph's form of the covariance.
  void condition(const Eigen::MatrixXd& H, const RangeBearing<double>& innovation) {
    const Eigen::Matrix2d S = sandwich(H, covariance) + R();
    const Eigen::Matrix2d per_S = S.ldlt().solve(Eigen::Matrix2d::Identity());
    const Eigen::MatrixXd K = product(product(covariance, H.transpose()), per_S);
    mean += product(K, to_vector(innovation));
    const Eigen::MatrixXd left = covariance - product(K, product(H, covariance));  // (I - K H) P
    covariance = left - product(product(left, H.transpose()), K.transpose()) + sandwich(K, R());
  }
  /// A landmark placed from the first three rows, with that derivative by them.
  void append(const Detection& detection, const LinearisedPlace<double>& placed,
              const Matrix23& by_pose) {
    const Eigen::Matrix2d Gz = observation_jacobian(placed);
    const Eigen::Index n = mean.size();
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n + 2, n);
    G.topRows(n).setIdentity();
    G.bottomLeftCorner<2, 3>() = by_pose;
    Eigen::MatrixXd grown = sandwich(G, covariance);
    grown.bottomRightCorner<2, 2>() += Gz * R() * Gz.transpose();
    covariance = grown;
    mean.conservativeResize(n + 2);
    mean.tail<2>() = to_vector(placed.point);
    identities_.push_back(detection.identity);
  }

 private:
  Belief belief_;
  Eigen::Index rows_before_;
  std::vector<std::int32_t> identities_;
};

/// Robocentric EKF-SLAM as Castellanos, Martinez-Cantin, Tardos and Neira 2007 have it. The state
/// is (base, motion, landmarks), all in the frame of the vehicle at the scan before: the pose of
/// the map's frame, that of the vehicle, points. Detections correct all of it, then it is composed
/// into the frame of the vehicle now.
class RobocentricEkfSlam : public FullGaussian {
 public:
  explicit RobocentricEkfSlam(const Belief& belief) : FullGaussian(belief, 6) {}

  void start(const Pose& start) {
    start_ = start;
    FullGaussian::start(Eigen::VectorXd::Zero(6));
  }
  void predict(const Control& control, double duration) {
    const auto step = linearised_move(pose_at(3), control, duration, belief().vehicle);
    move(3, step.pose, pose_jacobian(step.jacobians), control_jacobian(step.jacobians));
  }
  void update(Scan scan) {
    bool is_composed = false;
    const auto compose_once = [&] {
      if (!std::exchange(is_composed, true)) compose();
    };
    use(
        scan,
        [&](const Detection& detection, Eigen::Index row) {
          const auto at = linearised_observation(pose_at(3), point_at(row));
          condition(derivative(3, row, at), residual(observation_of(detection), at.observation));
        },
        [&](const Detection& detection) {
          compose_once();
          const auto placed = linearised_place(Pose{}, observation_of(detection));
          append(detection, placed, Matrix23::Zero());
        });
    compose_once();
  }

  /// The pose in the map: start (+) (base^-1 (+) motion).
  PoseMoments moments() const {
    const Eigen::Matrix2d B = rotation(-mean(2)), W = rotation(start_.heading);
    const Eigen::Vector2d way = B * (mean.segment<2>(3) - mean.head<2>());
    const Eigen::Vector2d place = Eigen::Vector2d(start_.x, start_.y) + W * way;
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(3, mean.size());
    T.block<2, 2>(0, 0) = -W * B;
    T.block<2, 1>(0, 2) = W * Eigen::Vector2d(way.y(), -way.x());
    T.block<2, 2>(0, 3) = W * B;
    T(2, 2) = -1.0;
    T(2, 5) = 1.0;
    return {{place.x(), place.y(), wrap(start_.heading + mean(5) - mean(2))},
            sandwich(T, covariance)};
  }

 private:
  static Eigen::Matrix2d rotation(double angle) {
    return Eigen::Matrix2d{{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}};
  }
  /// (-) motion (+) everything, linearised at the corrected motion.
  void compose() {
    const Eigen::Matrix2d back = rotation(-mean(5));
    const Eigen::Vector2d moved = mean.segment<2>(3);
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(mean.size(), mean.size());
    const auto carry = [&](Eigen::Index row) {
      const Eigen::Vector2d now = back * (mean.segment<2>(row) - moved);
      mean.segment<2>(row) = now;
      T.block<2, 2>(row, row) = back;
      T.block<2, 2>(row, 3) = -back;
      T.block<2, 1>(row, 5) = Eigen::Vector2d(now.y(), -now.x());
    };
    carry(0);
    T(2, 2) = 1.0;
    T(2, 5) = -1.0;
    mean(2) = wrap(mean(2) - mean(5));
    for (Eigen::Index row = 6; row < mean.size(); row += 2) carry(row);
    mean.segment<3>(3).setZero();
    covariance = sandwich(T, covariance);
  }

  Pose start_;
};

}  // namespace montecarta::filters::reference
