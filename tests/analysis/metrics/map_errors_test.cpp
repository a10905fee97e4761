// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/map_errors.hpp"

#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/random/stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const std::vector<Eigen::Vector2d> kWorld = {{0, 0}, {10, 0}, {20, 0}};
const std::vector<double> kPath = {0, 0, 0};
const MapCriteria kCriteria{true, {}, true};

FinalMap map_of(std::vector<std::uint32_t> seen, std::vector<Eigen::Vector2d> mean) {
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

/// Runs whose maps are wrong by `inflation` times what they say.
struct WrongMaps {
  MapErrorSums sums;
  SummaryOf nees, rms;

  WrongMaps(std::uint64_t runs, double inflation) {
    RngStream draw({.seed = 9});
    for (std::uint64_t run = 0; run < runs; ++run) {
      std::vector<Eigen::Vector2d> mean = kWorld;
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
  const MapErrors errors = consistent.sums.result(0.95, true);
  const Summary nees = consistent.nees.result();
  EXPECT_EQ(errors.missing, "");
  EXPECT_NEAR(nees.mean, 2.0, 5.0 * nees.standard_error());
  EXPECT_NEAR(consistent.rms.result().mean, std::sqrt(0.5), 0.05);
  EXPECT_EQ(errors.landmarks[0].runs, 400u);
  EXPECT_EQ(errors.share_inside(), 1.0);
  EXPECT_EQ(WrongMaps(400, 2.0).sums.result(0.95, true).share_inside(), 0.0);
}

TEST(MapErrors, SayWhyThereAreNone) {
  MapErrorSums sums;
  EXPECT_THAT(sums.result(0.95, true).missing, HasSubstr("no run is complete"));
  sums.add(std::nullopt);
  EXPECT_THAT(sums.result(0.95, true).missing, HasSubstr("add final_map to record.columns"));
  EXPECT_THAT(sums.result(0.95, false).missing, HasSubstr("nobody knows"));
  sums.add(map_scores(map_of({1, 0, 0}, kWorld), kCriteria, kWorld, kPath));
  EXPECT_THAT(sums.result(0.95, true).missing, HasSubstr("the maps of 1 runs are not whole"));
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
}

}  // namespace
}  // namespace montecarta::analysis
