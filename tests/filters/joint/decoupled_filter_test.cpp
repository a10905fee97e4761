// SPDX-License-Identifier: BSD-3-Clause
// The decoupled right-invariant EKF (Yang, Chen, Lee, Huang, RA-L 2022), in the plane: the pose has
// a right-invariant error, landmarks have additive ones and derivatives at their first estimates.
#include "filters/joint/joint_filter.hpp"
#include "filters/joint/joint_gaussian.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace montecarta::filters {
namespace {

enum class PoseStep {
  straight,    ///< by the additive error, with the derivative of the exponential
  exponential  ///< by the exponential
};

/// The error is (xi, e_1, ..., e_m), with xi_p = e_p - J p e_heading at the predicted place p. Rows
/// are x, y, heading, then the landmarks.
class DecoupledFilter {
 public:
  DecoupledFilter(const Belief& belief, PoseStep pose_step)
      : belief_(belief), pose_step_(pose_step) {}

  void start(const Pose& start) {
    x_ = Eigen::Vector3d(start.x, start.y, start.heading);
    P_.setZero(3, 3);
    predicted_ = start;
  }
  void predict(const StepContext& /*context*/, const Control& control, double duration) {
    motion_.advance(control, duration, belief_);
  }
  void update(const StepContext& /*context*/, Scan scan) {
    move();
    const std::vector<std::int32_t> known = identities_;
    for (const Detection& seen : scan) {
      const auto found = std::ranges::find(known, seen.identity);
      if (found != known.end()) observe(seen, found - known.begin());
    }
    for (const Detection& seen : scan) {
      if (std::ranges::find(known, seen.identity) == known.end()) append(seen);
    }
  }
  PoseMoments moments() const {
    return {{x_(0), x_(1), x_(2)}, T() * P_.topLeftCorner<3, 3>() * T().transpose()};
  }

 private:
  Eigen::Matrix2d noise_of_detection() const {
    return deviations_of(belief_.sensor, belief_).cwiseAbs2().asDiagonal();
  }
  /// Derivative of the additive error of the pose by xi.
  Eigen::Matrix3d T() const {
    Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
    T.topRightCorner<2, 1>() = quarter_turned(place_of(predicted_));
    return T;
  }
  /// A motion leaves xi as it is.
  void move() {
    const PoseGaussian<double> moved = motion_.from(Pose{x_(0), x_(1), x_(2)});
    predicted_ = moved.mean;
    x_.head<3>() << predicted_.x, predicted_.y, predicted_.heading;
    const Eigen::Matrix3d B = T().inverse();
    P_.topLeftCorner<3, 3>() += B * symmetric(moved.covariance) * B.transpose();
    motion_.restart();
  }
  auto detected(const Pose& pose, const Eigen::Vector2d& landmark) const {
    return linearised_detection(belief_.sensor, pose, Point{landmark.x(), landmark.y()}).value();
  }
  void observe(const Detection& seen, std::ptrdiff_t slot) {
    const Eigen::Index row = 3 + 2 * slot;
    const auto at = detected(predicted_, first_[static_cast<std::size_t>(slot)]);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, x_.size());
    H.leftCols<3>() = at.by_pose * T();
    H.middleCols<2>(row) = at.by_landmark;
    const Eigen::Matrix2d S = H * P_ * H.transpose() + noise_of_detection();
    const Eigen::MatrixXd K = S.llt().solve(H * P_).transpose();
    P_ -= (K * S * K.transpose()).eval();
    const auto latest = detected(Pose{x_(0), x_(1), x_(2)}, x_.segment<2>(row));
    step(K * models::residual(vector_of(seen), latest.value, wraps_of(belief_.sensor)));
  }
  void step(const Eigen::VectorXd& error) {
    const double turn = error(2);
    if (pose_step_ == PoseStep::straight) {
      x_.head<2>() += (T() * error.head<3>()).head<2>();
    } else {
      x_.head<2>() =
          rotation_by(turn) * x_.head<2>() + exponential_jacobian(turn) * error.head<2>();
    }
    x_(2) = wrap(x_(2) + turn);
    x_.tail(x_.size() - 3) += error.tail(x_.size() - 3);
  }
  /// e = xi_p + J theta xi_heading and the noise of the detection.
  void append(const Detection& seen) {
    const Pose pose{x_(0), x_(1), x_(2)};
    const PlacedLandmark placed = placed_landmark(belief_.sensor, pose, vector_of(seen)).value();
    const Eigen::Index n = x_.size();
    Eigen::MatrixXd G = Eigen::MatrixXd::Identity(n + 2, n);
    G.bottomRows<2>().setZero();
    G.bottomLeftCorner<2, 2>().setIdentity();
    G.block<2, 1>(n, 2) = quarter_turned(placed.point);
    P_ = (G * P_ * G.transpose()).eval();
    P_.bottomRightCorner<2, 2>() +=
        placed.by_detection * noise_of_detection() * placed.by_detection.transpose();
    x_.conservativeResize(n + 2);
    x_.tail<2>() = placed.point;
    first_.push_back(placed.point);
    identities_.push_back(seen.identity);
  }

  Belief belief_;
  PoseStep pose_step_;
  MotionIncrement motion_;
  Pose predicted_;
  Eigen::VectorXd x_;
  Eigen::MatrixXd P_;
  std::vector<std::int32_t> identities_;
  std::vector<Eigen::Vector2d> first_;  ///< first estimates of landmarks
};

class Decoupled : public testing::TestWithParam<SensorKind> {
 protected:
  static SmallWorldSettings bending(double scale) {
    SmallWorldSettings settings{.seed = 31, .scans = 150};
    settings.noise = {.control = {.sigma = {0.3 * scale, 0.1 * scale}},
                      .sigma_range = 0.1 * scale,
                      .sigma_bearing = 0.05 * scale,
                      .sigma_forward = 0.1 * scale,
                      .sigma_left = 0.1 * scale};
    settings.noise.sensor.kind = GetParam();
    return settings;
  }
  /// The largest differences of mean [m, rad] and covariance to fej_ekf_slam.
  static std::pair<double, double> differences(PoseStep pose_step, double scale) {
    const SmallWorldSettings settings = bending(scale);
    const SmallWorld world = small_world(settings);
    const Pose start{4.0, -3.0, 0.5};
    const auto first_estimates =
        estimates_of(*make_filter(fej_ekf_slam_kind(), settings), world, start);
    DecoupledFilter literal(settings.noise, pose_step);
    std::pair<double, double> largest;
    drive_through(literal, world, start, [&](std::size_t scan) {
      const PoseMoments a = literal.moments(), &b = first_estimates[scan];
      largest.first = std::max(largest.first, boxminus(a.mean, b.mean).norm());
      largest.second = std::max(largest.second, (a.covariance - b.covariance).norm());
    });
    return largest;
  }
};

TEST_P(Decoupled, RightInvariantWithAStraightStepIsFejEkfSlam) {
  const auto [mean, covariance] = differences(PoseStep::straight, 1.0);
  EXPECT_LT(mean, 1e-9);
  EXPECT_LT(covariance, 1e-9);
}

TEST_P(Decoupled, RightInvariantNearsItByTheSquareOfTheNoise) {
  EXPECT_GT(differences(PoseStep::exponential, 1.0).first, 1e-3);
  const double coarse = differences(PoseStep::exponential, 2e-2).first,
               fine = differences(PoseStep::exponential, 1e-2).first;
  EXPECT_NEAR(coarse / fine, 4.0, 0.4);
}

INSTANTIATE_TEST_SUITE_P(All, Decoupled,
                         testing::Values(SensorKind(RangeBearingSensor()),
                                         SensorKind(PositionSensor())),
                         [](const auto& instance) { return name_of(Sensor{instance.param}); });

}  // namespace
}  // namespace montecarta::filters
