// SPDX-License-Identifier: BSD-3-Clause
#include "tests/experiments/commands/program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

using ::testing::HasSubstr;

const std::string kYard = R"([study]
name = yard
runs = 1
[scenario]
kind = log
path = yard
[belief]
vehicle = differential_drive
sigma_speed = 0.1
sigma_yaw_rate_deg = 1
sigma_range = 0.1
sigma_bearing_deg = 1
[cells]
cell = ekf_slam
)";

class RecordedLog : public Program {
 protected:
  RecordedLog() {
    write("yard.ini", kYard);
    std::filesystem::create_directory(folder_ / "yard");
    write("yard/start.csv", "time_s,x_m,y_m,heading_rad\n0,0,0,0\n");
    write("yard/odometry.csv", "time_s,speed_mps,yaw_rate_radps\n0,1,0\n1,1,0.1\n2,1,0\n");
    write("yard/reference.csv", "time_s,x_m,y_m\n0.5,0.5,0\n1.5,1.5,0\n");
  }
  /// What the study in full says of the association.
  std::string association(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"check", "yard.ini", "--text"};
    words.insert(words.end(), more.begin(), more.end());
    const Called called = call(words);
    EXPECT_EQ(called.code, 0) << called.err;
    const std::size_t section = called.out.find("[association]\nkind = ");
    return called.out.substr(section + 21, called.out.find('\n', section + 21) - section - 21);
  }
};

TEST_F(RecordedLog, UsesItsIdentitiesUnlessTheStudySaysOtherwise) {
  write("yard/detections.csv", "time_s,range_m,bearing_rad,identity\n0.5,5,0.1,0\n1.5,4,0.2,0\n");
  EXPECT_EQ(association(), "known");
  EXPECT_THAT(call({"check", "yard.ini"}).out, HasSubstr("association: known"));
  EXPECT_EQ(association({"--set", "association.kind=nearest"}), "nearest");
  write("yard/detections.csv", "time_s,range_m,bearing_rad\n0.5,5,0.1\n1.5,4,0.2\n");
  EXPECT_EQ(association(), "nearest");
}

}  // namespace
}  // namespace montecarta::experiments
