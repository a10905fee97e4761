// SPDX-License-Identifier: BSD-3-Clause
// A pose correlated with its landmarks, by central differences: what one bent column gives is what
// sending all points through the model does.
#include "filters/moments/moment_transforms.hpp"
#include "tests/filters/moments/random_gaussians.hpp"
#include "tests/filters/reference/sigma_models.hpp"
#include "tests/filters/reference/square_root.hpp"

#include <gtest/gtest.h>

namespace montecarta {
namespace {

using reference::psd_chol;
using reference::Vector;
template <int N>
using Square = Eigen::Matrix<double, N, N>;

const double kInterval = std::sqrt(3.0);

SigmaPoints central() {
  const SigmaRule rule = central_difference_rule(kInterval);
  return SigmaPoints({rule, rule, rule}, Belief{}, MapUncertainty::on);
}

template <int N>
Square<N> random_square(RngStream& draw) {
  Square<N> A;
  for (double& value : A.reshaped()) value = draw.normal();
  return A;
}

/// The square root of P that is lower triangular in the coordinates y = T x, T of any kind.
template <int N>
Square<N> root_in(const Square<N>& T, const Square<N>& P) {
  return T.partialPivLu().solve(psd_chol<N>(T * P * T.transpose()));
}

/// Mean, covariance and cross-covariance of an image.
template <int M, int Angle, int N, class Model>
reference::Image<N, M> image_of(const Vector<N>& x, const Square<N>& S, const Model& model) {
  const auto image = reference::central_differences<M, Angle>(x, S, kInterval, model);
  return {image.mean, image.A * image.A.transpose() + image.B * image.B.transpose(),
          S * image.A.transpose()};
}

/// A random sight whose pose and landmark are correlated, as a map of one landmark.
struct CorrelatedSight {
  RandomSight sight;
  Square<5> P;
  CorrelatedMap<double> map{1};

  explicit CorrelatedSight(RngStream& draw) : sight(draw) {
    const Vector<5> scale(0.5, 0.5, 0.05, 0.8, 0.8);
    const Square<5> A = scale.asDiagonal() * random_square<5>(draw);
    P = A * A.transpose();
    map.add();
    map.pose(0) = {sight.pose.mean, symmetric_of(P.topLeftCorner<3, 3>())};
    map.landmark(0, 0) = {sight.landmark.mean, {P(3, 3), P(3, 4), P(4, 4)}};
    map.pose_cross(0, 0) = {{P(3, 0), P(3, 1), P(3, 2)}, {P(4, 0), P(4, 1), P(4, 2)}};
  }
  Vector<5> mean() const {
    const auto& [x, f] = std::pair(map.pose(0).mean, map.landmark(0, 0).mean);
    return {x.x, x.y, x.heading, f.x, f.y};
  }
  Square<5> covariance() const {
    Square<5> held;
    held.topLeftCorner<3, 3>() = symmetric(map.pose(0).covariance);
    held.bottomRightCorner<2, 2>() = symmetric(map.landmark(0, 0).covariance);
    const auto& [x, y] = map.pose_cross(0, 0);
    held.bottomLeftCorner<2, 3>() << x.x, x.y, x.h, y.x, y.y, y.h;
    held.topRightCorner<3, 2>() = held.bottomLeftCorner<2, 3>().transpose();
    return held;
  }
};

TEST(SigmaCorrelated, ASightUpdatesPoseAndLandmarkAsAllPointsDo) {
  RngStream draw({.seed = 101, .purpose = Draw::test});
  for (int n = 0; n < 300; ++n) {
    CorrelatedSight c(draw);
    Vector<7> x = Vector<7>::Zero();
    x.head<5>() = c.mean();
    const Vector<2> u = (x.segment<2>(3) - x.head<2>()).normalized();
    Square<5> T = Square<5>::Zero();  // across, along, heading, and the landmark's place
    T.row(0) << u(1), -u(0), 0.0, -u(1), u(0);
    T.row(1) << -u(0), -u(1), 0.0, u(0), u(1);
    T.bottomRightCorner<3, 3>().setIdentity();
    Square<7> S = Square<7>::Zero();
    S.topLeftCorner<5, 5>() = root_in<5>(T, c.P);
    S(5, 5) = std::sqrt(c.sight.noise.range), S(6, 6) = std::sqrt(c.sight.noise.bearing);
    const auto image = image_of<2, 1>(x, S, reference::SightModel{});
    const Eigen::Matrix<double, 5, 2> C = image.cross.topRows<5>();
    const Eigen::Matrix<double, 5, 2> K = image.covariance.llt().solve(C.transpose()).transpose();
    const Vector<2> nu = reference::difference<1, 2>(to_vector(c.sight.seen), image.mean);

    Evidence<double> evidence;
    absorb(c.map, 0, ForAll{0}, central(), c.sight.seen, c.sight.noise, Everywhere(), evidence);
    Vector<5> moved = c.mean() - x.head<5>() - K * nu;
    moved(2) = wrap(moved(2));
    EXPECT_LT(moved.norm(), 1e-10);
    EXPECT_LT((c.covariance() - c.P + K * image.covariance * K.transpose()).norm(), 1e-11);
    EXPECT_NEAR(evidence.log_density(), reference::log_gaussian<2>(nu, image.covariance), 1e-9);
  }
}

TEST(SigmaCorrelated, ANewLandmarkIsBornAsAllPointsDo) {
  RngStream draw({.seed = 102, .purpose = Draw::test});
  for (int n = 0; n < 300; ++n) {
    CorrelatedSight c(draw);
    Vector<5> x;
    x << c.mean().head<3>(), to_vector(c.sight.seen);
    Square<5> P = Square<5>::Zero();
    P.topLeftCorner<3, 3>() = c.P.topLeftCorner<3, 3>();
    P(3, 3) = c.sight.noise.range, P(4, 4) = c.sight.noise.bearing;
    Square<5> T = Square<5>::Zero();  // heading and bearing, x, y, range, bearing
    T(0, 2) = T(0, 4) = T(1, 0) = T(2, 1) = T(3, 3) = T(4, 4) = 1.0;
    const auto image = image_of<2, -1>(x, root_in<5>(T, P), [](const Vector<5>& at) {
      return reference::PlaceModel{Pose{at(0), at(1), at(2)}}(at.tail<2>());
    });
    const auto born =
        new_correlated_landmark(c.map.pose(0), c.sight.seen, c.sight.noise, central());
    const auto& [cx, cy] = born.pose_cross;
    Eigen::Matrix<double, 3, 2> cross;
    cross << cx.x, cy.x, cx.y, cy.y, cx.h, cy.h;
    EXPECT_LT((to_vector(born.landmark.mean) - image.mean).norm(), 1e-10);
    EXPECT_LT((symmetric(born.landmark.covariance) - image.covariance).norm(), 1e-10);
    EXPECT_LT((cross - image.cross.topRows<3>()).norm(), 1e-10);
  }
}

TEST(SigmaCorrelated, AnUncertainPoseIsDrivenOnAsAllPointsDo) {
  RngStream draw({.seed = 103, .purpose = Draw::test});
  for (int n = 0; n < 300; ++n) {
    CorrelatedSight c(draw);
    const Vector<5> before = c.mean();
    const Pose step{3.0 * draw.normal(), 2.0 * draw.normal(), 0.5 * draw.normal()};
    Square<5> T = Square<5>::Zero();  // heading, x, y, and the landmark
    T(0, 2) = T(1, 0) = T(2, 1) = T(3, 3) = T(4, 4) = 1.0;
    const auto image = image_of<3, 2>(before, root_in<5>(T, c.P), [&](const Vector<5>& at) {
      const Direction<double> d = direction_of(at(2));
      return Vector<3>(at(0) + d.cosine * step.x - d.sine * step.y,
                       at(1) + d.sine * step.x + d.cosine * step.y, wrap(at(2) + step.heading));
    });
    const Eigen::Matrix3d own = symmetric(random_pose_covariance(draw, 0.1, 0.02));
    drive(c.map, 0, MotionIncrement(step, symmetric_of(own)), central());
    const Symmetric3<double> turned_own =
        turned(symmetric_of(own), direction_of(c.sight.pose.mean.heading));
    Vector<3> moved = c.mean().head<3>() - image.mean;
    moved(2) = wrap(moved(2));
    EXPECT_LT(moved.norm(), 1e-10);
    const Eigen::Matrix3d P = c.covariance().topLeftCorner<3, 3>();
    EXPECT_LT((P - image.covariance - symmetric(turned_own)).norm(), 1e-10);
    EXPECT_LT((c.covariance().bottomLeftCorner<2, 3>() - image.cross.bottomRows<2>()).norm(),
              1e-10);
  }
}

}  // namespace
}  // namespace montecarta
