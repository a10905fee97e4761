// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/reference_scores.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace montecarta::analysis {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Points random_points(RngStream& draw, std::size_t n) {
  Points points;
  for (std::size_t i = 0; i < n; ++i) points.emplace_back(100.0 * draw.normal(), draw.normal());
  return points;
}

Points moved(const RigidMotion& motion, const Points& points) {
  Points images;
  for (const Eigen::Vector2d& point : points) images.push_back(motion(point));
  return images;
}

double squared_distance(const Points& a, const Points& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return sum;
}

TEST(RigidAlignment, RecoversAKnownTurnAndShift) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    RngStream draw({.seed = seed, .purpose = Draw::test});
    const Points points = random_points(draw, 20);
    const RigidMotion known{wrap(10.0 * draw.normal()), {draw.normal(), 5.0 * draw.normal()}};
    const RigidMotion found = rigid_alignment(points, moved(known, points));
    EXPECT_NEAR(wrap(found.angle - known.angle), 0.0, 1e-12) << seed;
    EXPECT_LT((found.shift - known.shift).norm(), 1e-12 * 100.0) << seed;
  }
}

TEST(RigidAlignment, IsTheBestOfAllMotionsNearby) {
  RngStream draw({.seed = 4, .purpose = Draw::test});
  const Points from = random_points(draw, 30), onto = random_points(draw, 30);
  const RigidMotion best = rigid_alignment(from, onto);
  const double least = squared_distance(moved(best, from), onto);
  for (const double step : {-1e-3, 1e-3}) {
    for (const RigidMotion& other :
         {RigidMotion{best.angle + step, best.shift},
          RigidMotion{best.angle, best.shift + Eigen::Vector2d(step, 0.0)},
          RigidMotion{best.angle, best.shift + Eigen::Vector2d(0.0, step)}}) {
      EXPECT_GT(squared_distance(moved(other, from), onto), least);
    }
  }
}

TEST(RigidAlignment, NeitherMirrorsNorStretches) {
  const Points from = {{0.0, 0.0}, {4.0, 0.0}, {4.0, 3.0}};
  Points mirrored = from, stretched = from;
  for (Eigen::Vector2d& point : mirrored) point.y() = -point.y();
  for (Eigen::Vector2d& point : stretched) point *= 2.0;
  for (const Points& onto : {mirrored, stretched}) {
    EXPECT_GT(squared_distance(moved(rigid_alignment(from, onto), from), onto), 1.0);
  }
}

TEST(RigidAlignment, ShiftsOnePointAndLeavesNone) {
  const RigidMotion motion = rigid_alignment(Points{{1.0, 2.0}}, Points{{-3.0, 5.0}});
  EXPECT_EQ(motion.angle, 0.0);
  EXPECT_EQ(motion.shift, Eigen::Vector2d(-4.0, 3.0));
  EXPECT_EQ(rigid_alignment({}, {}).shift, Eigen::Vector2d::Zero());
}

}  // namespace
}  // namespace montecarta::analysis
