// SPDX-License-Identifier: BSD-3-Clause
// Answers of a program, and messages to it.
#include "engine/random/stream.hpp"
#include "experiments/external/child_process.hpp"
#include "experiments/external/messages.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/matchers.hpp"

#include <Eigen/Eigenvalues>

#include <array>
#include <bit>

namespace montecarta::experiments {
namespace {

const std::string kGood =
    R"({"id":7,"mean":[1.5,-2,0.25],"covariance":[[4,1,0],[1,4,0],[0,0,0.01]])";

std::string reason(const std::string& line) {
  return engine::complaint_of<ProgramError>([&] { read_estimate(line, 7); });
}

std::string with_covariance(const std::string& covariance) {
  return R"({"id":7,"mean":[0,0,0],"covariance":)" + covariance + "}";
}

TEST(Answer, AnEstimateWithAllItMaySay) {
  const ProgramEstimate estimate = read_estimate(
      kGood + R"(,"log_likelihood":-3.5,"nis":2.5,"nis_dof":4,"ess":9.5,"map_size":12})", 7);
  EXPECT_EQ(estimate.pose.mean.x, 1.5);
  EXPECT_EQ(estimate.pose.mean.y, -2.0);
  EXPECT_EQ(estimate.pose.mean.heading, 0.25);
  EXPECT_EQ(estimate.pose.covariance(1, 0), 1.0);
  EXPECT_EQ(estimate.pose.covariance(2, 2), 0.01);
  EXPECT_EQ(estimate.report.log_likelihood, -3.5);
  EXPECT_EQ(estimate.report.nis, 2.5);
  EXPECT_EQ(estimate.report.nis_dof, 4U);
  EXPECT_EQ(estimate.report.ess, 9.5);
  EXPECT_EQ(estimate.report.map_size, 12.0);
}

TEST(Answer, HeadingsAreWrapped) {
  const auto estimate =
      read_estimate(R"({"id":7,"mean":[0,0,7],"covariance":[[1,0,0],[0,1,0],[0,0,1]]})", 7);
  EXPECT_EQ(estimate.pose.mean.heading, wrap(7.0));
}

TEST(Answer, WhatIsWrongIsSaidAndASingularCovarianceIsNot) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"ans = 5", "answer is not JSON: ans = 5"},
      {"", "answer is not JSON"},
      {kGood, "answer is not JSON"},
      {R"({"id":7,"mean":[NaN,0,0]})", "answer holds NaN or Infinity"},
      {R"({"id":7,"mean":[0,0,-Infinity]})", "answer holds NaN or Infinity"},
      {"[1,2]", "answer is no JSON object"},
      {R"({"mean":[0,0,0]})", "answer has not the message's id 7"},
      {R"({"id":6})", "answer has not the message's id 7"},
      {R"({"id":"7"})", "answer has not the message's id 7"},
      {R"({"id":7.0})", "answer has not the message's id 7"},
      {R"({"id":7})", "answer has no mean"},
      {R"({"id":7,"mean":[0,0,0]})", "answer has no covariance"},
      {R"({"id":7,"mean":[0,0,0],"covarience":1})", "unknown member 'covarience'"},
      {R"({"id":7,"mean":[0,0]})", "mean is no array of 3"},
      {R"({"id":7,"mean":3})", "mean is no array of 3"},
      {R"({"id":7,"mean":[0,null,0]})", "mean is not a number"},
      {R"({"id":7,"mean":[0,"1",0]})", "mean is not a number"},
      {R"({"id":7,"mean":[0,1e999,0]})", "answer is not JSON"},
      {R"({"id":7,"mean":[[[[0]]]]})", "too many brackets"},
      {with_covariance("[1,0,0,0,1,0,0,0,1]"), "covariance is no array of 3"},
      {with_covariance("[[1,0],[0,1],[0,0]]"), "row of the covariance is no array of 3"},
      {with_covariance("[[1,0,0],[0,null,0],[0,0,1]]"), "covariance is not a number"},
      {with_covariance("[[1,0.5,0],[0.4,1,0],[0,0,1]]"), "covariance is not symmetric"},
      {with_covariance("[[1,0,0],[0,-1,0],[0,0,1]]"), "not positive definite"},
      {with_covariance("[[1,2,0],[2,1,0],[0,0,1]]"), "not positive definite"},
      {with_covariance("[[1,1.000000002,0],[1.000000002,1,0],[0,0,1]]"), "not positive definite"},
      {with_covariance("[[1,1e-3,0],[1e-3,0,0],[0,0,1]]"), "correlation with a variance of zero"},
      {with_covariance("[[1e300,1e300,0],[1e300,1e-300,0],[0,0,1]]"), "beyond all bounds"},
      {kGood + R"(,"nis_dof":-1})", "nis_dof is no whole number from 0: -1"},
      {kGood + R"(,"nis_dof":1e99})", "nis_dof is no whole number"},
      {kGood + R"(,"nis":null})", "nis is not a number"},
      {kGood + R"(,"nis":-1e-3})", "nis is negative"}};
  for (const auto& [line, expected] : cases) EXPECT_THAT(reason(line), HasSubstr(expected)) << line;
  EXPECT_EQ(reason(with_covariance("[[0,0,0],[0,0,0],[0,0,0]]")), "nothing");
  EXPECT_EQ(reason(with_covariance("[[1,1,0],[1,1,0],[0,0,1e-12]]")), "nothing");
  EXPECT_EQ(reason(with_covariance("[[1,1.0000000005,0],[1.0000000005,1,0],[0,0,1]]")), "nothing");
  EXPECT_EQ(reason(with_covariance("[[1e-300,0,0],[0,1e300,0],[0,0,1]]")), "nothing");
}

TEST(Answer, AMapByNumber) {
  std::array<std::optional<LandmarkEstimate>, 3> map;
  const auto read = [&](const std::string& rows, Association association) {
    map.fill(std::nullopt);
    return engine::complaint_of<ProgramError>(
        [&] { read_map(R"({"id":1,"map":)" + rows + "}", 1, association, map); });
  };
  EXPECT_EQ(read("[[2,1,2,4,1,9]]", Association::known), "nothing");
  ASSERT_TRUE(map[2] && !map[0] && !map[1]);
  EXPECT_EQ(map[2]->mean, Eigen::Vector2d(1, 2));
  EXPECT_EQ(map[2]->covariance(1, 0), 1.0);
  EXPECT_EQ(read("[]", Association::known), "nothing");
  EXPECT_THAT(read("[[3,1,2,4,1,9]]", Association::known),
              HasSubstr("landmark 3, the world has 3"));
  EXPECT_EQ(read("[[3,1,2,4,1,9]]", Association::nearest), "nothing");
  EXPECT_THAT(read("[[1,1,2,4,1,9],[1,1,2,4,1,9]]", Association::known), HasSubstr("1 twice"));
  EXPECT_THAT(read("[[0,1,2,4,9,9]]", Association::known), HasSubstr("not positive definite"));
  EXPECT_THAT(read("[[-1,1,2,4,1,9]]", Association::known), HasSubstr("no whole number"));
  EXPECT_THAT(read("7", Association::known), HasSubstr("map is no array"));
}

// Law: any answer is a pose and a covariance, or the run fails with a reason.
TEST(Answer, FuzzOfEstimates) {
  const std::string good =
      R"({"id":7,"mean":[1.5,-2,0.25],"covariance":)"
      R"([[4,-3.9,0],[-3.9,4,0],[0,0,1]],"nis":2.5,"nis_dof":4,"log_likelihood":-1e-3})";
  int accepted = 0;
  for (std::uint64_t seed = 0; seed < 100'000; ++seed) {
    const std::string line = engine::damaged_text(good, seed);
    try {
      const ProgramEstimate estimate = read_estimate(line, 7);
      ++accepted;
      const Eigen::Matrix3d& P = estimate.pose.covariance;
      ASSERT_TRUE(P.allFinite() && P == P.transpose()) << line;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(P);
      ASSERT_GE(solver.eigenvalues()(0), -1e-8 * solver.eigenvalues()(2)) << line;
      ASSERT_TRUE(std::isfinite(estimate.pose.mean.x + estimate.pose.mean.y)) << line;
      ASSERT_LE(std::abs(estimate.pose.mean.heading), kPi) << line;
      ASSERT_TRUE(std::isfinite(estimate.report.nis)) << line;
    } catch (const ProgramError& error) {
      ASSERT_STRNE(error.what(), "") << line;
    }
  }
  EXPECT_GT(accepted, 1000);  // the fuzz reaches the code behind the parser
}

TEST(Answer, FuzzOfMaps) {
  int accepted = 0;
  for (std::uint64_t seed = 0; seed < 20'000; ++seed) {
    const std::string line =
        engine::damaged_text(R"({"id":1,"map":[[2,1,2,4,1,9],[0,-1,2.5,4e-3,1e-4,9]]})", seed);
    std::array<std::optional<LandmarkEstimate>, 3> map;
    try {
      read_map(line, 1, Association::known, map);
      ++accepted;
      for (const auto& landmark : map) {
        ASSERT_TRUE(!landmark || landmark->mean.allFinite()) << line;
      }
    } catch (const ProgramError&) {
    }
  }
  EXPECT_GT(accepted, 200);
}

// Law: numbers keep their bits on the way to a program and back.
TEST(Answer, NumbersRoundTrip) {
  RngStream random(StreamIdentity{.seed = 23});
  for (int i = 0; i < 10'000; ++i) {
    const double x = std::bit_cast<double>(random.bits());
    if (!std::isfinite(x)) continue;
    const ControlRow controls[] = {{x, 3.0, 0.0}};
    const std::string message = predict_message(0, controls);
    const std::size_t begin = message.find("[[") + 2;
    const std::string text = message.substr(begin, message.find(',', begin) - begin);
    EXPECT_NE(text.find_first_of(".e"), std::string::npos) << text;
    const auto back = read_estimate(
        R"({"id":7,"mean":[)" + text + R"(,0,0],"covariance":[[1,0,0],[0,1,0],[0,0,1]]})", 7);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back.pose.mean.x), std::bit_cast<std::uint64_t>(x));
  }
}

const std::vector<ControlRow> kDriven = {{3.0, -0.25, 0.025}};
const std::vector<Detection> kSeen = {{10.5, 0.1, 4}, {2.0, -1.0, Detection::kClutter}};

TEST(ExternalMessages, AScanHasIdentitiesOnlyWhereTheyAreKnown) {
  EXPECT_EQ(scan_message(7, kDriven, kSeen, Association::known, 2),
            R"({"id":7,"type":"scan","controls":[[3.0,-0.25,0.025]],)"
            R"("detections":[[10.5,0.1,4],[2.0,-1.0,-1]]})");
  // Law: who must associate is told no identity, nor which detection is a false alarm.
  EXPECT_EQ(scan_message(7, {}, kSeen, Association::nearest, 2),
            R"({"id":7,"type":"scan","controls":[],"detections":[[10.5,0.1,-1],[2.0,-1.0,-1]]})");
}

TEST(ExternalMessages, AStartWithAllThatIsBelieved) {
  FilterSetup setup{.belief = {}, .association = {}, .options = FilterOptions({}), .landmarks = 35};
  setup.belief.vehicle = Car{.kind = Car::Kind::rear_wheel, .wheelbase = 2.83};
  setup.association.kind = Association::nearest;
  EXPECT_EQ(start_message(0, {.run = 12, .seed = 4'000'000'000, .pose = {1.0, -2.5, 0.0}}, setup),
            R"({"id":0,"type":"start","run":12,"seed":4000000000,"start":[1.0,-2.5,0.0],)"
            R"("settings":{"vehicle":"rear_wheel","wheelbase":2.83,"wheel_left":0.0,)"
            R"("sensor_ahead":0.0,"sensor_left":0.0,"controls":["speed","steer"],)"
            R"("sigma_speed":0.3,"sigma_steer":0.05,)"
            R"("sensor":"range_bearing","sigma_range":0.1,"sigma_bearing":0.02,)"
            R"("association":"nearest",)"
            R"("gate":5.991464547107979,"new_gate":25.0,"landmarks":35}})");
}

TEST(ExternalMessages, SayWhichControlsARobotHas) {
  FilterSetup setup{.belief = {}, .association = {}, .options = FilterOptions({}), .landmarks = 35};
  setup.belief.vehicle = DifferentialDrive{.integration = Integration::euler};
  setup.belief.control = {.sigma = {0.1, 0.25}, .alpha = {0.5, 0.0, 0.0, 0.125}};
  const std::string text = start_message(0, {.run = 0, .seed = 1, .pose = {}}, setup);
  EXPECT_NE(text.find(R"("vehicle":"differential_drive","integration":"euler",)"
                      R"("controls":["speed","yaw_rate"],"sigma_speed":0.1,"sigma_yaw_rate":0.25,)"
                      R"("alpha_1":0.5,"alpha_2":0.0,"alpha_3":0.0,"alpha_4":0.125,)"
                      R"("sensor":"range_bearing","sigma_range")"),
            std::string::npos)
      << text;
}

TEST(ExternalMessages, SayWhatASensorMeasuresAndWhereItIs) {
  FilterSetup setup{.belief = {}, .association = {}, .options = FilterOptions({}), .landmarks = 35};
  setup.belief.sigma_bearing = 0.125;
  setup.belief.sensor = {BearingSensor(), {.forward = 0.5, .left = 0.0, .turn = -1.5}};
  const std::string text = start_message(0, {.run = 0, .seed = 1, .pose = {}}, setup);
  EXPECT_NE(text.find(R"("sensor":"bearing_only","sigma_bearing":0.125,)"
                      R"("mount_forward":0.5,"mount_left":0.0,"mount_turn":-1.5,"association")"),
            std::string::npos)
      << text;
  EXPECT_EQ(scan_message(7, {}, {{Detection{{0.5, 0.0}, 4}}}, Association::known, 1),
            R"({"id":7,"type":"scan","controls":[],"detections":[[0.5,4]]})");
}

TEST(ExternalMessages, PredictionsAndMaps) {
  EXPECT_EQ(predict_message(2, kDriven),
            R"({"id":2,"type":"predict","controls":[[3.0,-0.25,0.025]]})");
  EXPECT_EQ(map_message(3), R"({"id":3,"type":"map"})");
}

}  // namespace
}  // namespace montecarta::experiments
