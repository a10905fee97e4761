// SPDX-License-Identifier: BSD-3-Clause
// Filters of the literature, written down with full matrices, and which of them are one filter.
#include "filters/joint/joint_filter.hpp"
#include "filters/joint/joint_gaussian.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::filters {
namespace {

enum class Side {
  right,  ///< truth = exp(xi) estimate
  left    ///< truth = estimate exp(xi)
};
enum class Reset {
  none,  ///< the covariance of xi stays while the estimate moves
  full   ///< it is carried along by the derivative of the exponential
};

/// Derivative of exponential_jacobian().
Eigen::Matrix2d exponential_bend(double a) {
  const bool small = std::abs(a) < 1e-3;
  const double along =
      small ? -a / 3.0 + a * a * a / 30.0 : (a * std::cos(a) - std::sin(a)) / (a * a);
  const double across =
      small ? 0.5 - a * a / 8.0 : (a * std::sin(a) - (1.0 - std::cos(a))) / (a * a);
  return Eigen::Matrix2d{{along, -across}, {across, along}};
}

/// The extended Kalman filter over the error xi of pose and landmarks as an element of SE(2) with
/// more than one position. With T xi = e the additive error, its matrices are those of EKF-SLAM
/// times T. Rows are x, y, heading, then the landmarks.
class GroupFilter {
 public:
  GroupFilter(const Belief& belief, Side side, Reset reset)
      : belief_(belief), side_(side), reset_(reset) {}

  void start(const Pose& start) {
    x = Eigen::Vector3d(start.x, start.y, start.heading);
    P.setZero(3, 3);
    identities_.clear();
    motion_.restart();
  }
  void predict(const StepContext& /*context*/, const Control& control, double duration) {
    motion_.advance(control, duration, belief_);
  }
  void update(const StepContext& /*context*/, Scan scan) {
    move();
    const std::vector<std::int32_t> known = identities_;
    for (const Detection& seen : scan) {
      const auto found = std::ranges::find(known, seen.identity);
      if (found != known.end()) observe(seen, 3 + 2 * (found - known.begin()));
    }
    for (const Detection& seen : scan) {
      if (std::ranges::find(known, seen.identity) == known.end()) append(seen);
    }
  }
  PoseMoments moments() const {
    const Eigen::MatrixXd e = T() * P * T().transpose();
    return {pose(), e.topLeftCorner<3, 3>()};
  }

  Eigen::VectorXd x;
  Eigen::MatrixXd P;  ///< covariance of xi

 private:
  Pose pose() const { return {x(0), x(1), x(2)}; }
  Eigen::Matrix2d rotation() const { return Eigen::Rotation2Dd(x(2)).toRotationMatrix(); }
  Eigen::Matrix2d noise_of_detection() const {
    return deviations_of(belief_.sensor, belief_).cwiseAbs2().asDiagonal();
  }
  std::vector<Eigen::Index> points() const {
    std::vector<Eigen::Index> rows{0};
    for (Eigen::Index row = 3; row < x.size(); row += 2) rows.push_back(row);
    return rows;
  }
  Eigen::MatrixXd T() const {
    Eigen::MatrixXd T = Eigen::MatrixXd::Identity(x.size(), x.size());
    for (const Eigen::Index row : points()) {
      if (side_ == Side::left) T.block<2, 2>(row, row) = rotation();
      if (side_ == Side::right) T.block<2, 1>(row, 2) = quarter_turned(x.segment<2>(row));
    }
    return T;
  }
  void move() {
    const PoseGaussian<double> moved = motion_.from(pose());
    Eigen::MatrixXd F = Eigen::MatrixXd::Identity(x.size(), x.size());
    F.block<2, 1>(0, 2) = quarter_turned(place_of(moved.mean) - x.head<2>());
    Eigen::MatrixXd e = F * T() * P * (F * T()).transpose();
    e.topLeftCorner<3, 3>() += symmetric(moved.covariance);
    x.head<3>() << moved.mean.x, moved.mean.y, moved.mean.heading;
    const Eigen::PartialPivLU<Eigen::MatrixXd> now(T());
    P = now.solve(now.solve(e).transpose());
    motion_.restart();
  }
  void observe(const Detection& seen, Eigen::Index row) {
    const auto at = linearised_detection(belief_.sensor, pose(), Point{x(row), x(row + 1)}).value();
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, x.size());
    H.leftCols<3>() = at.by_pose;
    H.middleCols<2>(row) = at.by_landmark;
    H = (H * T()).eval();
    const Eigen::Matrix2d S = H * P * H.transpose() + noise_of_detection();
    const Eigen::MatrixXd K = S.llt().solve(H * P).transpose();
    P -= (K * S * K.transpose()).eval();
    step(K * models::residual(vector_of(seen), at.value, wraps_of(belief_.sensor)));
  }
  void step(const Eigen::VectorXd& xi) {
    const double a = xi(2), sign = side_ == Side::right ? 1.0 : -1.0;
    const Eigen::Matrix2d V = exponential_jacobian(a), R = rotation(),
                          turn = Eigen::Rotation2Dd(a).toRotationMatrix();
    Eigen::MatrixXd carry = Eigen::MatrixXd::Identity(x.size(), x.size());
    for (const Eigen::Index row : points()) {
      const Eigen::Vector2d way = xi.segment<2>(row);
      const Eigen::Matrix2d Vc = exponential_jacobian(sign * a);
      carry.block<2, 2>(row, row) = Vc;
      carry.block<2, 1>(row, 2) =
          sign * (exponential_bend(sign * a) * way - quarter_turn() * Vc * way);
      const Eigen::Vector2d from = x.segment<2>(row);
      if (side_ == Side::right) x.segment<2>(row) = turn * from + V * way;
      if (side_ == Side::left) x.segment<2>(row) = from + R * V * way;
    }
    x(2) = wrap(x(2) + a);
    if (reset_ == Reset::full) P = (carry * P * carry.transpose()).eval();
  }
  void append(const Detection& seen) {
    const PlacedLandmark placed = placed_landmark(belief_.sensor, pose(), vector_of(seen)).value();
    const Eigen::Index n = x.size();
    Eigen::MatrixXd G = Eigen::MatrixXd::Identity(n + 2, n);
    G.bottomRows<2>().setZero();
    G.bottomLeftCorner<2, 3>() = placed.by_pose;
    Eigen::MatrixXd e = G * T() * P * (G * T()).transpose();
    e.bottomRightCorner<2, 2>() +=
        placed.by_detection * noise_of_detection() * placed.by_detection.transpose();
    x.conservativeResize(n + 2);
    x.tail<2>() = placed.point;
    identities_.push_back(seen.identity);
    const Eigen::PartialPivLU<Eigen::MatrixXd> now(T());
    P = now.solve(now.solve(e).transpose());
  }

  Belief belief_;
  Side side_;
  Reset reset_;
  MotionIncrement motion_;
  std::vector<std::int32_t> identities_;
};

/// Noise that bends the models.
SmallWorldSettings bent() {
  return {
      .seed = 31, .scans = 150, .noise = {.control = {.sigma = {0.3, 0.1}}, .sigma_bearing = 0.05}};
}

std::vector<PoseMoments> moments_of(Side side, Reset reset) {
  GroupFilter filter(bent().noise, side, reset);
  std::vector<PoseMoments> moments;
  drive_through(filter, small_world(bent()), {4.0, -3.0, 0.5},
                [&](std::size_t) { moments.push_back(filter.moments()); });
  return moments;
}

/// The largest difference [m, rad] of two filters in the mean of the pose.
double largest_difference(const std::vector<PoseMoments>& a, const std::vector<PoseMoments>& b) {
  double largest = 0.0;
  for (std::size_t scan = 0; scan < a.size(); ++scan)
    largest = std::max(largest, boxminus(a[scan].mean, b[scan].mean).norm());
  return largest;
}

std::vector<PoseMoments> riekf_slam() {
  const auto filter = make_filter(riekf_slam_kind(), bent());
  std::vector<PoseMoments> moments;
  drive_through(*filter, small_world(bent()), {4.0, -3.0, 0.5},
                [&](std::size_t) { moments.push_back(filter->estimate().spread); });
  return moments;
}

// arXiv 2507.04568
TEST(SameFilters, LeftAndRightInvariantWithTheFullReset) {
  const auto right = moments_of(Side::right, Reset::full),
             left = moments_of(Side::left, Reset::full);
  EXPECT_LT(largest_difference(right, left), 1e-9);
  for (std::size_t scan = 0; scan < right.size(); ++scan)
    EXPECT_LT((right[scan].covariance - left[scan].covariance).norm(), 1e-9) << scan;
}

TEST(SameFilters, RightInvariantWithoutResetAndRiekfSlam) {
  EXPECT_LT(largest_difference(moments_of(Side::right, Reset::none), riekf_slam()), 1e-9);
}

TEST(DifferentFilters, LeftInvariantWithoutResetAndRightInvariantWithIt) {
  EXPECT_GT(largest_difference(moments_of(Side::left, Reset::none), riekf_slam()), 1e-2);
  EXPECT_GT(largest_difference(moments_of(Side::right, Reset::full), riekf_slam()), 1e-6);
}

}  // namespace
}  // namespace montecarta::filters
