// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/motion_increment.hpp"
#include "tests/filters/moments/random_gaussians.hpp"
#include "tests/filters/reference/sigma_models.hpp"
#include "tests/filters/reference/square_root.hpp"

#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

using reference::blocks;
using reference::chol_in;
using reference::heading_first;
using reference::Vector;

/// A motion so far, a step to come, and what is believed of both.
struct Case {
  MotionIncrement before;
  Control control;
  Belief belief;
  Vector<7> x = Vector<7>::Zero();
  Eigen::Matrix<double, 7, 7> S;

  explicit Case(RngStream& draw) {
    const Pose pose{draw.normal(), draw.normal(), wrap(7.0 * draw.normal())};
    before = {pose, random_pose_covariance(draw, 0.5, 0.2)};
    control = {5.0 * draw.normal(), 0.5 * draw.normal()};
    if (draw.uniform() < 0.5) {
      belief.vehicle = Car{Car::Kind::rear_wheel, 2.83, 0.76, 3.78, 0.5};
      control[1] *= 0.5;  // sampled angles stay below the one at which the wheel stands still
    }
    belief.control.sigma = {draw.uniform(), 0.3 * draw.uniform()};
    x.head<3>() << pose.x, pose.y, pose.heading;
    const Vector<2> Q(belief.control.sigma[0], belief.control.sigma[1]), R(0.3, 0.1);
    const Eigen::Matrix2d q = Q.asDiagonal(), r = R.asDiagonal();
    S = blocks<3, 2, 2>(chol_in<3>(heading_first(), symmetric(before.covariance())), q, r);
  }
  reference::MotionModel model() const { return {control, 0.4, belief.vehicle}; }
};

void expect_near(const MotionIncrement& moved, const Vector<3>& mean, const Eigen::Matrix3d& P) {
  EXPECT_LT(boxminus(moved.pose(), reference::as_pose(mean)).norm(), 1e-13 * (1 + mean.norm()));
  EXPECT_LT((symmetric(moved.covariance()) - P).norm(), 1e-13 * (1 + P.norm()));
}

TEST(SigmaMotion, EqualsFifteenUnscentedPointsOfSevenDimensions) {
  RngStream draw({.seed = 82, .purpose = Draw::test});
  for (int n = 0; n < 500; ++n) {
    const Case c(draw);
    const auto image =
        reference::unscented<3, 2>(c.x, c.S, {.alpha = 0.9, .beta = 2.0, .kappa = -2.0}, c.model());
    expect_near(
        moved_by_sigma_points(c.before, c.control, 0.4, c.belief, unscented_rule(5, 0.9, 2, 0)),
        image.mean, image.covariance);
  }
}

TEST(SigmaMotion, EqualsFifteenCentralDifferencePointsOfSevenDimensions) {
  RngStream draw({.seed = 92, .purpose = Draw::test});
  const double h = std::sqrt(3.0);
  for (int n = 0; n < 500; ++n) {
    const Case c(draw);
    const auto image = reference::central_differences<3, 2>(c.x, c.S, h, c.model());
    expect_near(
        moved_by_sigma_points(c.before, c.control, 0.4, c.belief, central_difference_rule(h)),
        image.mean, image.A * image.A.transpose() + image.B * image.B.transpose());
  }
}

TEST(SigmaMotion, WithoutNoiseIsTheVehicleItself) {
  Belief sure;
  sure.control = {};
  const MotionIncrement moved = moved_by_sigma_points(MotionIncrement(), {3.0, 0.2}, 0.025, sure,
                                                      unscented_rule(5, 0.9, 2, 0));
  EXPECT_LT(boxminus(moved.pose(), move(Pose(), Control{3.0, 0.2}, 0.025, sure.vehicle)).norm(),
            1e-16);
  EXPECT_EQ(symmetric(moved.covariance()).norm(), 0.0);
}

}  // namespace
}  // namespace montecarta::filters
