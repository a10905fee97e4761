// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/map_scores.hpp"

#include "analysis/run/measured_run.hpp"
#include "analysis/run/reference_scores.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/map_error_sums.hpp"
#include "analysis/study/score_table.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"
#include "tests/doubles/matchers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <vector>

namespace montecarta::analysis {
namespace {

using Points = std::vector<Eigen::Vector2d>;

const Points kWorld = {{0, 0}, {10, 0}, {20, 0}};
const std::vector<double> kPath = {0, 0, 0};
const MapCriteria kCriteria{true, {}, true};

FinalMap map_of(std::vector<std::uint32_t> seen, Points mean) {
  const std::vector<Eigen::Matrix2d> covariance(seen.size(), 0.25 * Eigen::Matrix2d::Identity());
  return {std::move(seen), std::move(mean), covariance};
}

TEST(MapScores, JudgeTheLandmarksInTheMapByIdentity) {
  const MapScores scores =
      map_scores(map_of({1, 1, 0}, {{0.3, 0.4}, {10, 1}, {99, 99}}), kCriteria, kWorld, kPath);
  EXPECT_DOUBLE_EQ(scores.rms, std::sqrt((0.25 + 1.0) / 2.0));
  EXPECT_DOUBLE_EQ(scores.nees, (1.0 + 4.0) / 2.0);
  EXPECT_EQ(scores.gospa.missed, 1.0);
  EXPECT_EQ(scores.gospa.spurious, 0.0);
  EXPECT_FALSE(scores.landmarks[2].in_map);
}

TEST(MapScores, LeaveIdentityOutWhereItIsUnknown) {
  const MapCriteria criteria{true, {}, false};
  const MapScores scores = map_scores(map_of({1}, {{10, 1}}), criteria, kWorld, kPath);
  EXPECT_TRUE(std::isnan(scores.rms));
  EXPECT_THAT(scores.landmarks, IsEmpty());
  EXPECT_DOUBLE_EQ(scores.gospa.localisation, 1.0);
}

TEST(MapScores, MissOnlyWhatCameIntoView) {
  const MapCriteria criteria{true, FieldOfView(12.0, kPi), true};
  EXPECT_EQ(map_scores(map_of({0, 0, 0}, kWorld), criteria, kWorld, kPath).gospa.missed, 1.0)
      << "the first is not strictly ahead, the last is out of range";
}

TEST(MapScores, CountACovarianceThatIsNoNumber) {
  FinalMap map = map_of({1, 1, 1}, kWorld);
  map.covariance[1].setConstant(std::numeric_limits<double>::quiet_NaN());
  map.covariance[2].setZero();
  const MapScores scores = map_scores(map, kCriteria, kWorld, kPath);
  EXPECT_EQ(scores.undefined, 2u);
  EXPECT_EQ(scores.nees, 0.0);
  EXPECT_EQ(scores.rms, 0.0);
}

/// Runs with map errors of `inflation` times the reported deviations.
struct WrongMaps {
  MapErrorSums sums;
  SummaryOf nees, rms;

  WrongMaps(std::uint64_t runs, double inflation) {
    RngStream draw({.seed = 9});
    for (std::uint64_t run = 0; run < runs; ++run) {
      Points mean = kWorld;
      for (Eigen::Vector2d& at : mean) {
        at += 0.5 * inflation * Eigen::Vector2d(draw.normal(), draw.normal());
      }
      const MapScores scores = map_scores(map_of({1, 1, 1}, mean), kCriteria, kWorld, kPath);
      sums.add(scores);
      nees.add(scores.nees);
      rms.add(scores.rms);
    }
  }
};

TEST(MapErrors, FindAConsistentMapInsideItsBounds) {
  const WrongMaps consistent(400, 1.0);
  const MapErrors errors = consistent.sums.result(0.95, {.known = true});
  const Summary nees = consistent.nees.result();
  EXPECT_EQ(errors.missing, "");
  EXPECT_NEAR(nees.mean, 2.0, 5.0 * nees.standard_error());
  EXPECT_NEAR(consistent.rms.result().mean, std::sqrt(0.5), 0.05);
  EXPECT_EQ(errors.landmarks[0].runs, 400u);
  EXPECT_EQ(errors.share_inside(), 1.0);
  EXPECT_EQ(WrongMaps(400, 2.0).sums.result(0.95, {.known = true}).share_inside(), 0.0);
}

TEST(MapErrors, SayWhyThereAreNone) {
  MapErrorSums sums;
  EXPECT_THAT(sums.result(0.95, {.known = true}).missing, HasSubstr("no run is complete"));
  sums.add(std::nullopt);
  EXPECT_THAT(sums.result(0.95, {.known = true}).missing,
              HasSubstr("add final_map to record.columns"));
  EXPECT_THAT(sums.result(0.95, {.known = false}).missing, HasSubstr("nobody knows"));
  sums.add(map_scores(map_of({1, 0, 0}, kWorld), kCriteria, kWorld, kPath));
  EXPECT_THAT(sums.result(0.95, {.known = true}).missing,
              HasSubstr("the maps of 1 runs are not whole"));
}

TEST(MapErrors, GiveEveryRunItsScores) {
  ScoreTable scores;
  MeasuredRun run;
  scores.add(run);
  run.map = map_scores(map_of({1, 0, 0}, kWorld), kCriteria, kWorld, kPath);
  scores.add(run);
  EXPECT_TRUE(std::isnan(scores.column("gospa")[0]));
  EXPECT_DOUBLE_EQ(scores.column("gospa")[1], 5.0);
  EXPECT_EQ(scores.column("landmarks_missed")[1], 2.0);
  EXPECT_EQ(scores.column("landmark_rms")[1], 0.0);
  EXPECT_DOUBLE_EQ(scores.column("landmark_deviation")[1], std::sqrt(0.5));
}

Points drawn(std::size_t n, double size, RngStream& draw) {
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    points.emplace_back(size * draw.uniform(), size * draw.uniform());
  }
  return points;
}

double cost_of(const Eigen::MatrixXd& cost, const std::vector<std::size_t>& columns) {
  double sum = 0.0;
  for (Eigen::Index r = 0; r < cost.rows(); ++r) {
    sum += cost(r, static_cast<Eigen::Index>(columns[static_cast<std::size_t>(r)]));
  }
  return sum;
}

/// The least cost of all ways to give each row a column of its own.
double least_of_all(const Eigen::MatrixXd& cost) {
  std::vector<std::size_t> order(static_cast<std::size_t>(cost.cols()));
  std::iota(order.begin(), order.end(), 0);
  double least = cost_of(cost, order);
  while (std::next_permutation(order.begin(), order.end())) {
    least = std::min(least, cost_of(cost, order));
  }
  return least;
}

TEST(Assignment, IsTheCheapestOfAll) {
  RngStream draw({.seed = 3});
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Index rows = 1 + draw.below(6), columns = rows + draw.below(2);
    Eigen::MatrixXd cost(rows, columns);
    // Whole numbers, so that many costs are equal.
    for (double& one : cost.reshaped()) one = static_cast<double>(draw.below(8)) - 2.0;
    const auto found = cheapest_assignment(cost);
    EXPECT_EQ(std::set(found.begin(), found.end()).size(), found.size()) << "each column once";
    EXPECT_DOUBLE_EQ(cost_of(cost, found), least_of_all(cost)) << trial;
  }
  EXPECT_TRUE(cheapest_assignment(Eigen::MatrixXd(0, 3)).empty());
}

/// The definition: a pair that is farther apart than the cutoff is no pair.
double by_trying_all(const Points& few, const Points& many) {
  if (few.size() > many.size()) return by_trying_all(many, few);
  constexpr double kSquare = kGospaCutoff * kGospaCutoff;
  Eigen::MatrixXd cost(few.size(), many.size());
  for (Eigen::Index r = 0; r < cost.rows(); ++r) {
    for (Eigen::Index c = 0; c < cost.cols(); ++c) {
      const auto from = static_cast<std::size_t>(r), to = static_cast<std::size_t>(c);
      cost(r, c) = std::min((few[from] - many[to]).squaredNorm(), kSquare);
    }
  }
  const double unpaired = static_cast<double>(many.size() - few.size());
  return std::sqrt(0.5 * kSquare * unpaired + least_of_all(cost));
}

TEST(Gospa, EqualsTheBestOfAllAssignments) {
  RngStream draw({.seed = 11});
  for (int trial = 0; trial < 200; ++trial) {
    const Points map = drawn(draw.below(7), 15.0, draw), truth = drawn(draw.below(7), 15.0, draw);
    const Gospa found = gospa(map, truth);
    EXPECT_NEAR(found.distance, by_trying_all(map, truth), 1e-12) << trial;
    EXPECT_NEAR(found.distance * found.distance,
                found.localisation * found.localisation + 12.5 * (found.missed + found.spurious),
                1e-9);
  }
}

TEST(Gospa, CountsWhatIsMissedAndWhatIsInvented) {
  const Points truth = {{0, 0}, {10, 0}, {20, 0}};
  const Gospa found = gospa(Points{{0.3, 0.4}, {10, 6}}, truth);
  EXPECT_DOUBLE_EQ(found.localisation, 0.5);
  EXPECT_EQ(found.missed, 2.0);
  EXPECT_EQ(found.spurious, 1.0);
  EXPECT_DOUBLE_EQ(found.distance, std::sqrt(0.25 + 3 * 12.5));
  EXPECT_EQ(gospa(truth, truth).distance, 0.0);
  EXPECT_EQ(gospa({}, truth).missed, 3.0);
  EXPECT_EQ(gospa(truth, {}).spurious, 3.0);
}

TEST(Gospa, GivesAPlaceThatIsNoNumberNoPartner) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Gospa found = gospa(Points{{nan, 0}}, Points{{0, 0}});
  EXPECT_EQ(found.missed, 1.0);
  EXPECT_EQ(found.spurious, 1.0);
}

// A greedy choice takes the pair of distance 0 first and pays 16 for the rest; the best pays 2 x 4.
TEST(Gospa, LooksAtTheWholeAndNotAtTheNearestPair) {
  const Gospa found = gospa(Points{{0, 0}, {2, 0}}, Points{{2, 0}, {4, 0}});
  EXPECT_DOUBLE_EQ(found.distance, std::sqrt(8.0));
}

const Points kBeacons = {{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}};

TEST(BeaconScores, CountsBeaconsWithinAMetreAndMeasuresThem) {
  const BeaconScores scores =
      beacon_scores(Points{{0.6, 0.0}, {10.6, 0.0}, {10.0, 11.1}, {50.0, 50.0}}, kBeacons, {});
  EXPECT_EQ(scores.found, 2.0);
  EXPECT_NEAR(scores.rms, 0.6, 1e-12);
  EXPECT_NEAR(scores.aligned_rms, 0.6, 1e-12);
}

TEST(BeaconScores, FindsThemWhereThePathIsAlignedAndSaysHowFarTheyWere) {
  const RigidMotion along_x{.angle = 0.0, .shift = {-3.0, 0.0}};
  const BeaconScores scores =
      beacon_scores(Points{{3.0, 0.0}, {13.0, 0.1}, {13.0, 10.0}}, kBeacons, along_x);
  EXPECT_EQ(scores.found, 3.0);
  EXPECT_NEAR(scores.rms, std::sqrt(9.0 + 0.01 / 3.0), 1e-12);
  EXPECT_NEAR(scores.aligned_rms, std::sqrt(0.01 / 3.0), 1e-12);
}

TEST(BeaconScores, ALandmarkStandsForOneBeaconTheNearerFirst) {
  const Points close = {{0.0, 0.0}, {1.0, 0.0}};
  const BeaconScores one = beacon_scores(Points{{0.7, 0.0}}, close, {});
  EXPECT_EQ(one.found, 1.0);
  EXPECT_NEAR(one.rms, 0.3, 1e-12);
  EXPECT_EQ(beacon_scores(Points{{0.7, 0.0}, {0.6, 0.0}}, close, {}).found, 2.0);
}

TEST(BeaconScores, FindsNothingInAnEmptyMap) {
  const BeaconScores scores = beacon_scores({}, kBeacons, {});
  EXPECT_EQ(scores.found, 0.0);
  EXPECT_TRUE(std::isnan(scores.rms));
}

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
