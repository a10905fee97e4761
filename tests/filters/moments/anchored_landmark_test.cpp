// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/eigen_jacobians.hpp"
#include "filters/moments/moment_transforms.hpp"
#include "tests/filters/moments/random_gaussians.hpp"
#include "tests/filters/reference/gaussian.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta {
namespace {

Belief sensor(double sigma_range, double sigma_bearing_deg) {
  Belief belief;
  belief.sigma_range = sigma_range, belief.sigma_bearing = sigma_bearing_deg * kPi / 180.0;
  return belief;
}

/// A landmark born somewhere, with any covariance of range and bearing, and seen from elsewhere.
struct SeenFromElsewhere {
  AnchoredLandmark<double> landmark;
  Pose pose;
  RangeBearing<double> seen;
  SensorNoise noise;

  explicit SeenFromElsewhere(RngStream& draw, double scale = 1.0) {
    const auto pose_at = [&](double width) {
      return Pose{width * draw.normal(), width * draw.normal(), wrap(7.0 * draw.normal())};
    };
    landmark.anchor = pose_at(4.0), pose = pose_at(4.0);
    landmark.mean = {20.0 + 15.0 * draw.uniform(), 3.0 * (2.0 * draw.uniform() - 1.0)};
    Eigen::Matrix2d A;
    A << draw.normal(), draw.normal(), 0.1 * draw.normal(), 0.1 * draw.normal();
    const Eigen::Matrix2d P = scale * scale * A * A.transpose();
    landmark.rr = P(0, 0), landmark.rb = P(0, 1), landmark.bb = P(1, 1);
    noise = {std::pow(scale * (0.2 + draw.uniform()), 2),
             std::pow(0.1 * scale * (0.2 + draw.uniform()), 2)};
    const RangeBearing<double> sight = predicted_sight(pose, as_gaussian(landmark).mean);
    seen = {sight.range + scale * draw.normal(), wrap(sight.bearing + 0.1 * scale * draw.normal())};
  }
};

/// h(x, g(a, q)), and its derivatives by differences.
Eigen::Vector2d sight_of_q(const SeenFromElsewhere& c, const Eigen::Vector2d& q) {
  const double angle = c.landmark.anchor.heading + q(1);
  const Point f{c.landmark.anchor.x + q(0) * std::cos(angle),
                c.landmark.anchor.y + q(0) * std::sin(angle)};
  return to_vector(predicted_sight(c.pose, f));
}
Eigen::Matrix2d derivatives(const SeenFromElsewhere& c, const Eigen::Vector2d& q) {
  Eigen::Matrix2d H;
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector2d step = 1e-5 * Eigen::Vector2d::Unit(k);
    Eigen::Vector2d difference = sight_of_q(c, q + step) - sight_of_q(c, q - step);
    difference(1) = wrap(difference(1));
    H.col(k) = difference / 2e-5;
  }
  return H;
}

TEST(AnchoredLandmark, IsUpdatedByThreeStepsOfGaussAndNewton) {
  RngStream draw({.seed = 241, .purpose = Draw::test});
  for (int n = 0; n < 500; ++n) {
    const SeenFromElsewhere c(draw);
    const Eigen::Vector2d q0(c.landmark.mean.range, c.landmark.mean.bearing);
    const Eigen::Matrix2d P{{c.landmark.rr, c.landmark.rb}, {c.landmark.rb, c.landmark.bb}};
    const Eigen::Matrix2d R = Eigen::Vector2d(c.noise.range, c.noise.bearing).asDiagonal();
    const auto innovation = [&](const Eigen::Vector2d& q) {
      Eigen::Vector2d nu = to_vector(c.seen) - sight_of_q(c, q);
      nu(1) = wrap(nu(1));
      return nu;
    };
    Eigen::Vector2d q = q0;
    Eigen::Matrix2d information;  // in the form that inverts P, as production does not
    for (int step = 0; step < 3; ++step) {
      const Eigen::Matrix2d H = derivatives(c, q);
      information = P.ldlt().solve(Eigen::Matrix2d::Identity()) + H.transpose() * R.ldlt().solve(H);
      const Eigen::Vector2d pull = H.transpose() * R.ldlt().solve(innovation(q) + H * (q - q0));
      q = q0 + information.ldlt().solve(pull);
    }
    const Eigen::Matrix2d H0 = derivatives(c, q0), S = H0 * P * H0.transpose() + R;

    AnchoredLandmark<double> landmark = c.landmark;
    Evidence<double> evidence;
    const auto v = update_anchored(landmark, c.pose, c.seen, c.noise, Everywhere(), evidence);
    EXPECT_NEAR(landmark.mean.range, q(0), 1e-5 * (1.0 + std::abs(q(0)))) << "case " << n;
    EXPECT_NEAR(landmark.mean.bearing, q(1), 1e-6) << "case " << n;
    const Eigen::Matrix2d after{{landmark.rr, landmark.rb}, {landmark.rb, landmark.bb}};
    EXPECT_LT((after * information - Eigen::Matrix2d::Identity()).norm(), 1e-4) << "case " << n;
    EXPECT_NEAR(evidence.log_density(), reference::log_gaussian<2>(innovation(q0), S), 1e-4);
    EXPECT_LT((Eigen::Vector2d(v.s_rr, v.s_bb) - S.diagonal()).norm(), 1e-5 * S.norm());
  }
}

TEST(AnchoredLandmark, WhereTheModelsAreStraightIsTheLandmarkOfFastSlam) {
  RngStream draw({.seed = 242, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const double scale = 1e-5;
    const SeenFromElsewhere c(draw, scale);
    AnchoredLandmark<double> anchored = c.landmark;
    LandmarkGaussian<double> cartesian = as_gaussian(c.landmark);
    Evidence<double> one, other;
    update_anchored(anchored, c.pose, c.seen, c.noise, Everywhere(), one);
    update_landmark(cartesian, c.pose, c.seen, c.noise, Everywhere(), other);
    const LandmarkGaussian<double> now = as_gaussian(anchored);
    EXPECT_LT((to_vector(now.mean) - to_vector(cartesian.mean)).norm(), 1e-3 * scale);
    EXPECT_LT((symmetric(now.covariance) - symmetric(cartesian.covariance)).norm(),
              1e-3 * scale * scale);
    EXPECT_NEAR(one.log_density(), other.log_density(), 1e-2);
  }
}

TEST(AnchoredLandmark, IsBornWhereFastSlamHasIt) {
  RngStream draw({.seed = 243, .purpose = Draw::test});
  for (int n = 0; n < 50; ++n) {
    const SeenFromElsewhere c(draw);
    const auto anchored = as_gaussian(new_anchored_landmark(c.pose, c.seen, c.noise));
    const auto cartesian = new_landmark(c.pose, c.seen, c.noise);
    EXPECT_LT((to_vector(anchored.mean) - to_vector(cartesian.mean)).norm(), 1e-12);
    EXPECT_LT((symmetric(anchored.covariance) - symmetric(cartesian.covariance)).norm(), 1e-11);
  }
}

TEST(AnchoredLandmark, TurningTheWorldChangesNothing) {
  RngStream draw({.seed = 244, .purpose = Draw::test});
  for (int n = 0; n < 100; ++n) {
    const SeenFromElsewhere c(draw);
    const Direction<double> d = direction_of(2.0);
    const auto turn = [&](const Pose& p) {
      return Pose{5.0 + d.cosine * p.x - d.sine * p.y, d.sine * p.x + d.cosine * p.y,
                  wrap(p.heading + 2.0)};
    };
    AnchoredLandmark<double> here = c.landmark, there = c.landmark;
    there.anchor = turn(c.landmark.anchor);
    Unweighed<double> nobody;
    update_anchored(here, c.pose, c.seen, c.noise, Everywhere(), nobody);
    update_anchored(there, turn(c.pose), c.seen, c.noise, Everywhere(), nobody);
    EXPECT_NEAR(here.mean.range, there.mean.range, 1e-9);
    EXPECT_NEAR(here.mean.bearing, there.mean.bearing, 1e-10);
    EXPECT_NEAR(here.bb, there.bb, 1e-12);
  }
}

TEST(AnchoredLandmark, TooNearIsLeftAlone) {
  AnchoredLandmark<double> landmark{{}, {10.0, 0.0}, 0.1, 0.0, 0.01};
  Evidence<double> evidence;
  update_anchored(landmark, Pose{10.0, 0.0, 0.0}, {0.5, 0.1}, {0.1, 0.1}, Everywhere(), evidence);
  EXPECT_EQ(landmark.mean.range, 10.0);
  EXPECT_EQ(landmark.rr, 0.1);
  EXPECT_EQ(evidence.left_out(), 1.0);
  EXPECT_EQ(evidence.log_density(), 0.0);
}

/// Mean error [m] and mean NEES of a landmark born from a wide bearing 25 m away and then seen
/// `n` times from two places to either side, over many trials.
struct Outcome {
  double bias = 0.0, nees = 0.0;
};
template <class Transform>
Outcome seen_again_from_the_sides(const Transform& transform, int n) {
  const Belief belief = sensor(1.2, 12.0);
  const SensorNoise noise = SensorNoise::of(belief);
  const Eigen::Vector2d truth(25.0, 0.0);
  constexpr int kTrials = 4000;
  Eigen::Vector2d error = Eigen::Vector2d::Zero();
  double nees = 0.0;
  for (std::uint64_t run = 0; run < kTrials; ++run) {
    RngStream draw({.seed = 245, .run = run, .purpose = Draw::test});
    const auto look = [&](const Pose& from) {
      RangeBearing<double> sight = predicted_sight(from, Point{truth.x(), truth.y()});
      sight.range += belief.sigma_range * draw.normal();
      sight.bearing = wrap(sight.bearing + belief.sigma_bearing * draw.normal());
      return sight;
    };
    auto landmark = transform.birth(Pose(), look(Pose()), noise);
    Unweighed<double> nobody;
    for (int k = 0; k < n; ++k) {
      const Pose from{12.0, k % 2 == 0 ? 12.0 : -12.0, 0.3};
      transform.update(landmark, from, look(from), noise, Everywhere(), nobody);
    }
    const LandmarkGaussian<double> now = as_gaussian(landmark);
    const Eigen::Vector2d e = truth - to_vector(now.mean);
    error += e / kTrials;
    nees += e.dot(symmetric(now.covariance).llt().solve(e)) / kTrials;
  }
  return {error.norm(), nees};
}

TEST(AnchoredLandmark, HasNotTheBiasOfAGaussianInTheMap) {
  for (const int n : {1, 2, 4, 8}) {
    const Outcome anchored = seen_again_from_the_sides(Anchored(), n);
    const Outcome cartesian = seen_again_from_the_sides(Linearised(), n);
    EXPECT_LT(anchored.bias, 0.3 * cartesian.bias) << n << " more sights";
    EXPECT_GT(cartesian.bias, 0.15) << n << " more sights";
    EXPECT_NEAR(anchored.nees, 2.0, 5.0 * 2.0 / std::sqrt(4000.0)) << n << " more sights";
    EXPECT_GT(cartesian.nees, 2.4) << n << " more sights";
  }
}

}  // namespace
}  // namespace montecarta
