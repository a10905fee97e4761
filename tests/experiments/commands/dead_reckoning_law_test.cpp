// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "engine/records/result_file.hpp"
#include "tests/experiments/commands/program.hpp"

#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

const std::string kStudy = R"([study]
name = dead
runs = 300
[scenario]
world = blink.csv
speed = 1
sigma_range = 0.1
[cells]
cell = dead_reckoning label=dead
)";

class DeadReckoning : public Program {
 protected:
  /// The average NEES of the first scans is where one of a million consistent filters is not.
  void expect_consistent_beginning(const std::string& what) const {
    const auto cell = analysis::analyze(ResultFile(folder_ / "out.h5")).cells.at(0);
    const auto* pose = cell.find_nees(analysis::ErrorBlock::pose, cell.leading);
    ASSERT_NE(pose, nullptr);
    const analysis::Interval band = analysis::nees_bounds(300, 3, 1.0 - 1e-6);
    for (std::size_t s = 0; s < 3; ++s) {
      EXPECT_GT(pose->series.average[s], band.lower) << "scan " << s << " of " << what;
      EXPECT_LT(pose->series.average[s], band.upper) << "scan " << s << " of " << what;
    }
  }
};

// Law: dead reckoning is consistent for every vehicle, noise and pair of rates. With one control
// step before a scan the covariance of two controls has rank 2.
TEST_F(DeadReckoning, IsConsistentFromTheFirstScanOn) {
  write("dead.ini", kStudy);
  write("blink.csv", kBlinkWorld);
  const std::vector<std::vector<std::string>> vehicles = {
      {"vehicle=front_axle", "sigma_speed=0.1"},
      {"vehicle=rear_wheel", "sigma_speed=0.1"},
      {"vehicle=differential_drive", "sigma_speed=0.1", "integration=arc"},
      {"vehicle=differential_drive", "sigma_speed=0.1", "integration=euler"},
      {"vehicle=omnidirectional", "integration=arc"},
      {"vehicle=omnidirectional", "integration=euler"}};
  for (const std::vector<std::string>& vehicle : vehicles) {
    for (const char* noise : {"noise=matched", "noise=measured-control"}) {
      for (const char* rate : {"control_rate=1", "control_rate=2", "control_rate=10"}) {
        std::vector<std::string> settings = vehicle;
        settings.insert(settings.end(), {noise, rate, "scan_rate=1"});
        std::vector<std::string> words = {"run", "dead.ini", "-o", "out.h5", "--quiet", "--force"};
        for (const std::string& setting : settings) {
          words.insert(words.end(), {"--set", "scenario." + setting});
        }
        const Called called = call(words);
        ASSERT_EQ(called.code, 0) << called.err;
        expect_consistent_beginning(testing::PrintToString(settings));
      }
    }
  }
}

}  // namespace
}  // namespace montecarta::experiments
