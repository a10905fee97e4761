// SPDX-License-Identifier: BSD-3-Clause
// The laws of every sensor, wherever it is mounted.
#include "engine/random/stream.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/models/field_of_view.hpp"
#include "filters/models/range_bearing.hpp"
#include "filters/models/triangulation.hpp"
#include "tests/filters/some_models.hpp"

#include <gtest/gtest.h>

namespace montecarta::models {
namespace {

// Derivatives and placing are held to the laws of every sensor.
TEST(RangeBearing, PredictedIsWhatIsLinearised) {
  RngStream draw({.seed = 31, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const Pose pose{10.0 * draw.normal(), 10.0 * draw.normal(), wrap(7.0 * draw.normal())};
    const Point landmark{20.0 * draw.normal(), 20.0 * draw.normal()};
    const auto change = residual(predicted_observation(pose, landmark),
                                 linearised_observation(pose, landmark).observation);
    EXPECT_LT(to_vector(change).norm(), 1e-12) << "case " << n;
  }
}

TEST(RangeBearing, ResidualCrossesTheBackwardDirection) {
  const auto difference =
      residual(RangeBearing<double>{5.0, kPi - 0.1}, RangeBearing<double>{4.5, -kPi + 0.1});
  EXPECT_DOUBLE_EQ(difference.range, 0.5);
  EXPECT_NEAR(difference.bearing, -0.2, 1e-12);
}

TEST(RangeBearing, KnowsWhenALandmarkIsTooNear) {
  EXPECT_TRUE(too_near(predicted_observation(Pose{1.0, 1.0, 0.0}, Point{1.0 + 1e-7, 1.0})));
  EXPECT_FALSE(too_near(predicted_observation(Pose{1.0, 1.0, 0.0}, Point{1.001, 1.0})));
}

/// Pose (x, y, heading) and landmark (x, y).
using Scene = Eigen::Matrix<double, 5, 1>;

Scene random_scene(RngStream& draw) {
  Scene scene;
  scene << 10.0 * draw.normal(), 10.0 * draw.normal(), wrap(7.0 * draw.normal()),
      20.0 * draw.normal(), 20.0 * draw.normal();
  return scene;
}
Pose pose_of(const Scene& s) { return {s(0), s(1), s(2)}; }
Point landmark_of(const Scene& s) { return {s(3), s(4)}; }

/// Central differences of a function of a vector.
template <int N, class Function>
Eigen::Matrix<double, 2, N> slopes(const Eigen::Matrix<double, N, 1>& at, const Wraps& wraps,
                                   const Function& f) {
  constexpr double kStep = 1e-5;
  Eigen::Matrix<double, 2, N> J;
  for (Eigen::Index i = 0; i < N; ++i) {
    Eigen::Matrix<double, N, 1> ahead = at, behind = at;
    ahead(i) += kStep;
    behind(i) -= kStep;
    J.col(i) = residual(f(ahead), f(behind), wraps) / (2.0 * kStep);
  }
  return J;
}

class EverySensor : public testing::TestWithParam<SomeSensor> {
 protected:
  const Sensor& sensor() const { return GetParam().sensor; }
  Eigen::Vector2d seen(const Scene& s) const {
    return linearised_detection(sensor(), pose_of(s), landmark_of(s))->value;
  }
};

TEST_P(EverySensor, DerivativesEqualCentralDifferences) {
  RngStream draw({.seed = 41, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const Scene scene = random_scene(draw);
    const auto at = linearised_detection(sensor(), pose_of(scene), landmark_of(scene));
    ASSERT_TRUE(at);
    const auto expected =
        slopes<5>(scene, wraps_of(sensor()), [&](const Scene& s) { return seen(s); });
    EXPECT_LT((at->by_pose - expected.leftCols<3>()).norm(), 1e-6) << "case " << n;
    EXPECT_LT((at->by_landmark - expected.rightCols<2>()).norm(), 1e-6) << "case " << n;
  }
}

TEST_P(EverySensor, TurningAndShiftingTheWorldChangesNothing) {
  RngStream draw({.seed = 42, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const Scene scene = random_scene(draw);
    const double angle = 1.0 + n;
    const Eigen::Matrix2d turn{{std::cos(angle), -std::sin(angle)},
                               {std::sin(angle), std::cos(angle)}};
    const Eigen::Vector2d shift(4.0, -9.0);
    Scene other = scene;
    other.head<2>() = turn * scene.head<2>() + shift;
    other(2) = wrap(scene(2) + angle);
    other.tail<2>() = turn * scene.tail<2>() + shift;
    EXPECT_LT(residual(seen(other), seen(scene), wraps_of(sensor())).norm(), 1e-11);
  }
}

TEST_P(EverySensor, PlacingALandmarkInvertsSeeingIt) {
  RngStream draw({.seed = 43, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    const Scene scene = random_scene(draw);
    const auto at = linearised_detection(sensor(), pose_of(scene), landmark_of(scene));
    const auto placed = placed_landmark(sensor(), pose_of(scene), at->value);
    ASSERT_EQ(placed.has_value(), fixes_landmark(sensor()));
    if (!placed) continue;
    EXPECT_LT((placed->point - scene.tail<2>()).norm(), 1e-12);
    EXPECT_LT((placed->by_detection * at->by_landmark - Eigen::Matrix2d::Identity()).norm(), 1e-11);
    EXPECT_LT((placed->by_pose + placed->by_detection * at->by_pose).norm(), 1e-11);
  }
}

TEST_P(EverySensor, SeesWhatAPerfectSensorDoesInItsView) {
  RngStream draw({.seed = 44, .purpose = Draw::test});
  const FieldOfView view(1e3, kTwoPi, sensor().mounting);
  for (int n = 0; n < 200; ++n) {
    const Scene scene = random_scene(draw);
    const std::vector<Eigen::Vector2d> landmarks{scene.tail<2>()};
    int times = 0;
    view.look(pose_of(scene), landmarks, [&](const InView& one) {
      const double bearing = std::atan2(one.dy, one.dx) - one.heading;
      const Eigen::Vector2d perfect = detection_of(sensor(), {one.range, bearing});
      EXPECT_LT(residual(perfect, seen(scene), wraps_of(sensor())).norm(), 1e-11);
      ++times;
    });
    EXPECT_EQ(times, 1);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EverySensor, testing::ValuesIn(some_sensors()),
                         [](const auto& instance) { return instance.param.name; });

TEST(FieldOfView, LooksWhereTheSensorIsMounted) {
  const FieldOfView view(10.0, kPi / 2, {.forward = 2.0, .left = 1.0, .turn = kPi / 2}, 0.5);
  const std::vector<Eigen::Vector2d> landmarks = {{2, 5}, {2, 1.4}, {7, 1}, {2, -3}, {2, 11.5}};
  std::vector<std::size_t> seen;
  view.look(Pose(), landmarks, [&](const InView& one) { seen.push_back(one.landmark); });
  EXPECT_EQ(seen, std::vector<std::size_t>{0});
}

/// Points (x, y) of two sights, the pose of the sensor, one or two measured numbers.
using Sights = Eigen::Matrix<double, 9, 1>;
constexpr double kVariance = 1e-4;

void expect_derivatives(const TriangulatedLandmark& at, const Eigen::Matrix<double, 2, 9>& J) {
  EXPECT_LT((at.by_first - J.middleCols<2>(0)).norm(), 1e-6);
  EXPECT_LT((at.by_second - J.middleCols<2>(2)).norm(), 1e-6);
  EXPECT_LT((at.by_pose - J.middleCols<3>(4)).norm(), 1e-6);
  EXPECT_LT((at.noise - kVariance * J.rightCols<2>() * J.rightCols<2>().transpose()).norm(), 1e-9);
}

TEST(Triangulation, RaysCrossAtTheLandmark) {
  const auto crossing = [](const Sights& s) {
    return crossing_of_rays(s.head<2>(), s.segment<2>(2), {s(4), s(5), s(6)}, s(7), kVariance);
  };
  Sights sights;  // the landmark is at (10, 5)
  sights << 0, 0, 2, 1, 8, -3, 0.4, std::atan2(8, 2) - 0.4, 0;
  EXPECT_LT((crossing(sights)->point - Eigen::Vector2d(10, 5)).norm(), 1e-12);
  expect_derivatives(*crossing(sights),
                     slopes<9>(sights, {}, [&](const Sights& s) { return crossing(s)->point; }));
  sights(7) += kPi;
  EXPECT_FALSE(crossing(sights)) << "behind the sensor";
}

TEST(Triangulation, CirclesCutOnBothSides) {
  for (const double side : {1.0, -1.0}) {
    const auto crossing = [&](const Sights& s) {
      return crossing_of_circles(s.head<2>(), s.segment<2>(2), s.tail<2>(), side, kVariance);
    };
    Sights sights;
    sights << 1, 2, 6, 2, 0, 0, 0, std::hypot(3, 4), std::hypot(2, 4);
    EXPECT_LT((crossing(sights)->point - Eigen::Vector2d(4, 2 + side * 4)).norm(), 1e-12);
    expect_derivatives(*crossing(sights),
                       slopes<9>(sights, {}, [&](const Sights& s) { return crossing(s)->point; }));
    sights(7) = 0.1;
    EXPECT_FALSE(crossing(sights)) << "they do not meet";
  }
}

}  // namespace
}  // namespace montecarta::models
