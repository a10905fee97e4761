// SPDX-License-Identifier: BSD-3-Clause
// What a program is told.
#include "experiments/external/messages.hpp"

#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

const std::vector<ControlRow> kDriven = {{3.0, -0.25, 0.025}};
const std::vector<Detection> kSeen = {{10.5, 0.1, 4}, {2.0, -1.0, Detection::kClutter}};

TEST(ExternalMessages, AScanWithIdentities) {
  EXPECT_EQ(scan_message(7, kDriven, kSeen, Association::known, 2),
            R"({"id":7,"type":"scan","controls":[[3.0,-0.25,0.025]],)"
            R"("detections":[[10.5,0.1,4],[2.0,-1.0,-1]]})");
}

// Law: who must associate is told no identity, nor which detection is a false alarm.
TEST(ExternalMessages, IdentitiesAreWithheld) {
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
