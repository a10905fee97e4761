// SPDX-License-Identifier: BSD-3-Clause
// Filters of the literature, written down with full matrices, and which of them are one filter.
#include "filters/joint/joint_filter.hpp"
#include "filters/joint/joint_gaussian.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
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
enum class Way {
  exponential,
  straight  ///< x <- x + T xi, the step of the affine EKF (arXiv 2412.10809)
};
enum class Update {
  by_derivatives,
  by_sigma_points  ///< of the whole state, plainly unscented: 2 n + 1 points, n + kappa = 3
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

/// The extended or unscented Kalman filter over the error xi of pose and landmarks as an element of
/// SE(2) with more than one position. With T xi = e the additive error, its matrices are those of
/// EKF-SLAM times T. Rows are x, y, heading, then the landmarks.
class GroupFilter {
 public:
  GroupFilter(const Belief& belief, Side side, Reset reset, Update update = Update::by_derivatives,
              Way way = Way::exponential)
      : belief_(belief), side_(side), reset_(reset), update_(update), way_(way) {}

  void start(const Pose& start) {
    x = Eigen::Vector3d(start.x, start.y, start.heading);
    P.setZero(3, 3);
    turn_ = Eigen::Vector3d(0.0, 0.0, 1.0);
    if (side_ == Side::left) turn_.head<2>() = rotation().transpose() * quarter_turned(x.head<2>());
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
      if (found == known.end()) continue;
      const Eigen::Index row = 3 + 2 * (found - known.begin());
      update_ == Update::by_derivatives ? observe(seen, row) : observe_points(seen, row);
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
  Eigen::MatrixXd P;         ///< covariance of xi
  double information = 0.0;  ///< about a rotation of vehicle and map (EQUATIONS (15.11))

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
    const Eigen::MatrixXd before = T();
    Eigen::MatrixXd e = F * before * P * (F * before).transpose();
    e.topLeftCorner<3, 3>() += symmetric(moved.covariance);
    x.head<3>() << moved.mean.x, moved.mean.y, moved.mean.heading;
    const Eigen::VectorXd turned = F * before * turn_;
    become(e, turned);
    motion_.restart();
  }
  void observe(const Detection& seen, Eigen::Index row) {
    const auto at = linearised_detection(belief_.sensor, pose(), Point{x(row), x(row + 1)}).value();
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, x.size());
    H.leftCols<3>() = at.by_pose;
    H.middleCols<2>(row) = at.by_landmark;
    H = (H * T()).eval();
    learn(H);
    const Eigen::Matrix2d S = H * P * H.transpose() + noise_of_detection();
    const Eigen::MatrixXd K = S.llt().solve(H * P).transpose();
    P -= (K * S * K.transpose()).eval();
    step(K * models::residual(vector_of(seen), at.value, wraps_of(belief_.sensor)));
  }
  /// The columns of a square root of P of which only three change the detection of a landmark:
  /// those of the difference of its error and the vehicle's, along and across the line of sight,
  /// and of the heading.
  Eigen::MatrixXd root(Eigen::Index row) const {
    const Eigen::Vector2d ray = (x.segment<2>(row) - x.head<2>()).normalized();
    Eigen::Matrix2d axes;
    axes << ray.transpose(), quarter_turned(ray).transpose();
    if (side_ == Side::left) axes = (axes * rotation()).eval();
    const Eigen::Index n = x.size();
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
    M.block<2, 2>(0, 0) = -axes;
    M.block<2, 2>(0, row) = axes;
    M(2, 2) = 1.0;
    for (Eigen::Index to = 3, from = 0; to < n; to += 2, from = from == 0 ? 3 : from + 2) {
      if (from == row) from = from + 2;
      M.block<2, 2>(to, from).setIdentity();
    }
    const Eigen::MatrixXd L = (M * P * M.transpose()).llt().matrixL();
    return M.partialPivLu().solve(L);
  }
  Eigen::VectorXd retracted(const Eigen::VectorXd& xi) const {
    Eigen::VectorXd moved = way_ == Way::straight ? Eigen::VectorXd(x + T() * xi) : x;
    moved(2) = wrap(x(2) + xi(2));
    if (way_ == Way::straight) return moved;
    const Eigen::Matrix2d V = exponential_jacobian(xi(2)), turn = rotation_by(xi(2));
    for (const Eigen::Index row : points()) {
      const Eigen::Vector2d way = V * xi.segment<2>(row), from = x.segment<2>(row);
      if (side_ == Side::right) moved.segment<2>(row) = turn * from + way;
      if (side_ == Side::left) moved.segment<2>(row) = from + rotation() * way;
    }
    return moved;
  }
  void observe_points(const Detection& seen, Eigen::Index row) {
    const Wraps wraps = wraps_of(belief_.sensor);
    const auto observed = [&](const Eigen::VectorXd& at) {
      const Point landmark{at(row), at(row + 1)};
      return linearised_detection(belief_.sensor, Pose{at(0), at(1), at(2)}, landmark)->value;
    };
    const Eigen::Index n = x.size();
    const double w = 1.0 / 6.0, middle = 1.0 - static_cast<double>(n) / 3.0;
    const Eigen::MatrixXd spread = std::sqrt(3.0) * root(row);
    const Eigen::Vector2d centre = observed(x);
    Eigen::Matrix2Xd y(2, 2 * n);
    for (Eigen::Index k = 0; k < n; ++k) {
      y.col(k) = models::residual(observed(retracted(spread.col(k))), centre, wraps);
      y.col(n + k) = models::residual(observed(retracted(-spread.col(k))), centre, wraps);
    }
    const Eigen::Matrix2Xd odd = 0.5 * (y.leftCols(n) - y.rightCols(n));
    learn(spread.transpose().partialPivLu().solve(odd.transpose()).transpose());
    const Eigen::Vector2d mean = w * y.rowwise().sum();
    Eigen::Matrix2d S = noise_of_detection() + middle * mean * mean.transpose();
    y.colwise() -= mean;
    S += w * y * y.transpose();
    const Eigen::MatrixXd C = 2.0 * w * spread * odd.transpose();
    const Eigen::MatrixXd K = S.llt().solve(C.transpose()).transpose();
    P -= (K * S * K.transpose()).eval();
    step(K * (models::residual(vector_of(seen), centre, wraps) - mean));
  }
  void step(const Eigen::VectorXd& xi) {
    const double a = xi(2), sign = side_ == Side::right ? 1.0 : -1.0;
    x = retracted(xi);
    Eigen::MatrixXd carry = Eigen::MatrixXd::Identity(x.size(), x.size());
    for (const Eigen::Index row : points()) {
      const Eigen::Vector2d way = xi.segment<2>(row);
      const Eigen::Matrix2d Vc = exponential_jacobian(sign * a);
      carry.block<2, 2>(row, row) = Vc;
      carry.block<2, 1>(row, 2) =
          sign * (exponential_bend(sign * a) * way - quarter_turn() * Vc * way);
    }
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
    const Eigen::VectorXd turned = G * T() * turn_;
    x.conservativeResize(n + 2);
    x.tail<2>() = placed.point;
    identities_.push_back(seen.identity);
    become(e, turned);
  }
  /// Takes the covariance of the additive error and the rotation in it for those of xi.
  void become(const Eigen::MatrixXd& e, const Eigen::VectorXd& turned) {
    const Eigen::PartialPivLU<Eigen::MatrixXd> now(T());
    P = now.solve(now.solve(e).transpose());
    turn_ = now.solve(turned);
  }
  void learn(const Eigen::MatrixXd& H) {
    const Eigen::Vector2d seen = H * turn_;
    information += seen.dot(noise_of_detection().llt().solve(seen));
  }

  Belief belief_;
  Side side_;
  Reset reset_;
  Update update_;
  Way way_;
  Eigen::VectorXd turn_;  ///< a rotation of vehicle and map by 1 rad, as the filter carries it
  MotionIncrement motion_;
  std::vector<std::int32_t> identities_;
};

/// Noise that bends the models.
SmallWorldSettings bent() {
  return {
      .seed = 31, .scans = 150, .noise = {.control = {.sigma = {0.3, 0.1}}, .sigma_bearing = 0.05}};
}

/// The same noise times `scale`.
SmallWorldSettings bent(double scale) {
  SmallWorldSettings world = bent();
  for (double& sigma : world.noise.control.sigma) sigma *= scale;
  for (double* sigma : {&world.noise.sigma_range, &world.noise.sigma_bearing,
                        &world.noise.sigma_forward, &world.noise.sigma_left})
    *sigma *= scale;
  return world;
}

std::vector<PoseMoments> moments_of(Side side, Reset reset, Update update = Update::by_derivatives,
                                    const SmallWorldSettings& settings = bent(),
                                    Way way = Way::exponential) {
  GroupFilter filter(settings.noise, side, reset, update, way);
  std::vector<PoseMoments> moments;
  drive_through(filter, small_world(settings), {4.0, -3.0, 0.5},
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
  return estimates_of(*filter, small_world(bent()), {4.0, -3.0, 0.5});
}

std::vector<PoseMoments> unscented(const FilterKind& kind, const SmallWorldSettings& settings) {
  const auto filter = make_filter(kind, settings, {{"motion", "linearised"}});
  return estimates_of(*filter, small_world(settings), {4.0, -3.0, 0.5});
}

using SensorAndSide = std::tuple<SensorKind, Side>;

class UnscentedOnAGroup : public testing::TestWithParam<SensorAndSide> {
 protected:
  const Side side_ = std::get<1>(GetParam());
  const FilterKind kind_ = side_ == Side::right ? right_ukf_slam_kind() : left_ukf_slam_kind();
  static SmallWorldSettings settings(double scale = 1.0) {
    SmallWorldSettings world = bent(scale);
    world.noise.sensor.kind = std::get<0>(GetParam());
    return world;
  }
  double difference_to_derivatives(double scale) const {
    return largest_difference(
        unscented(kind_, settings(scale)),
        moments_of(side_, Reset::none, Update::by_derivatives, settings(scale)));
  }
};

TEST_P(UnscentedOnAGroup, IsTheSigmaPointsOfTheWholeState) {
  const auto fast = unscented(kind_, settings()),
             plain = moments_of(side_, Reset::none, Update::by_sigma_points, settings());
  EXPECT_LT(largest_difference(fast, plain), 1e-9);
  for (std::size_t scan = 0; scan < fast.size(); ++scan)
    EXPECT_LT((fast[scan].covariance - plain[scan].covariance).norm(), 1e-9) << scan;
}

TEST_P(UnscentedOnAGroup, TakesDetectionsForAsMuchAboutTheHeadingOfTheWhole) {
  const SmallWorldSettings world = settings();
  GroupFilter plain(world.noise, side_, Reset::none, Update::by_sigma_points);
  drive_through(plain, small_world(world), {4.0, -3.0, 0.5});
  const auto fast = make_filter(kind_, world, {{"motion", "linearised"}});
  drive_through(*fast, small_world(world), {4.0, -3.0, 0.5});
  const double information = fast->report().own.front();
  EXPECT_NEAR(information, plain.information, 1e-9 * (1.0 + information));
  EXPECT_EQ(information < 1e-18, side_ == Side::right) << information;
  EXPECT_EQ(information > 100.0, side_ == Side::left) << information;
}

TEST_P(UnscentedOnAGroup, NearsTheFilterWithDerivativesByTheSquareOfTheNoise) {
  const double coarse = difference_to_derivatives(2e-2), fine = difference_to_derivatives(1e-2);
  EXPECT_GT(fine, 1e-9);
  EXPECT_NEAR(coarse / fine, 4.0, 0.4);
}

INSTANTIATE_TEST_SUITE_P(All, UnscentedOnAGroup,
                         testing::Combine(testing::Values(SensorKind(RangeBearingSensor()),
                                                          SensorKind(PositionSensor())),
                                          testing::Values(Side::right, Side::left)),
                         [](const auto& instance) {
                           return name_of(Sensor{std::get<0>(instance.param)}) +
                                  (std::get<1>(instance.param) == Side::right ? "Right" : "Left");
                         });

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

TEST(DifferentFilters, AffineAndRightInvariantByTheSquareOfTheNoise) {
  const auto difference = [](double scale) {
    const auto of = [&](Way way) {
      return moments_of(Side::right, Reset::none, Update::by_derivatives, bent(scale), way);
    };
    return largest_difference(of(Way::straight), of(Way::exponential));
  };
  EXPECT_GT(difference(1.0), 1e-3);
  EXPECT_NEAR(difference(2e-2) / difference(1e-2), 4.0, 0.4);
}

TEST(DifferentFilters, LeftInvariantWithoutResetAndRightInvariantWithIt) {
  EXPECT_GT(largest_difference(moments_of(Side::left, Reset::none), riekf_slam()), 1e-2);
  EXPECT_GT(largest_difference(moments_of(Side::right, Reset::full), riekf_slam()), 1e-6);
}

}  // namespace
}  // namespace montecarta::filters
