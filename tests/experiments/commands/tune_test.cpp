// SPDX-License-Identifier: BSD-3-Clause
#include "engine/random/stream.hpp"
#include "tests/experiments/commands/program.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <regex>
#include <sstream>

namespace montecarta::experiments {
namespace {

using testing::HasSubstr;

/// Localisation in a small known map, in which EKF-SLAM with the right noise is consistent.
const std::string kTunedStudy = R"([study]
name = ring
runs = 60
[scenario]
world = ring.csv
noise = matched
sigma_speed = 0.1
sigma_steer_deg = 1
sigma_range = 0.1
sigma_bearing_deg = 1
start_sigma_m = 0.1
start_sigma_deg = 1
[belief]
map = known
[cells]
cell = ekf_slam
)";

/// A ring of 20 m, with landmarks inside and outside.
const std::string kRing =
    "kind,x,y\nwaypoint,20,0\nwaypoint,40,20\nwaypoint,20,40\nwaypoint,0,20\n"
    "landmark,10,10\nlandmark,30,10\nlandmark,30,30\nlandmark,10,30\n"
    "landmark,20,-8\nlandmark,48,20\nlandmark,20,48\nlandmark,-8,20\n";

/// The drive of such a run without its truth, with half of the sensor's noise.
const std::string kTunedLog = R"([study]
name = log
runs = 1
[scenario]
kind = log
path = drives/runs/run_0000
max_range = 30
[belief]
vehicle = front_axle
wheelbase = 4
map = known
start_sigma_m = 0.1
start_sigma_deg = 1
sigma_speed = 0.1
sigma_steer_deg = 1
sigma_range = 0.05
sigma_bearing_deg = 0.5
[cells]
cell = ekf_slam
)";

/// The truth of an exported drive as a reference with the errors of `deviation` [m], and a fifth of
/// it in radians, at every fourth step. Positions are multiplied by `unit`. Without `states_errors`
/// its header names no errors.
std::string measured_reference(const std::string& truth, double deviation, double unit = 1.0,
                               bool states_errors = true) {
  std::istringstream lines(truth);
  std::ostringstream out;
  out.precision(17);
  std::string line;
  std::getline(lines, line);
  out << line << (states_errors ? ",sigma_x_m,sigma_y_m,sigma_heading_rad\n" : "\n");
  for (std::uint32_t row = 1; std::getline(lines, line); ++row) {
    if (row % 4 != 0) continue;
    std::array<double, 4> fix{};
    std::ranges::replace(line, ',', ' ');
    std::istringstream fields(line);
    for (double& field : fix) fields >> field;
    RngStream draw({1, 0, row, 0, Draw::world_fix});
    fix[1] = unit * (fix[1] + deviation * draw.normal());
    fix[2] = unit * (fix[2] + deviation * draw.normal());
    fix[3] += deviation / 5.0 * draw.normal();
    out << fix[0] << ',' << fix[1] << ',' << fix[2] << ',' << fix[3];
    if (states_errors) out << ',' << deviation << ',' << deviation << ',' << deviation / 5.0;
    out << '\n';
  }
  return out.str();
}

/// A factor as the table prints it: "2.01 [1.97, 2.05]".
struct PrintedFactor {
  double value = 0.0, lower = 0.0, upper = 0.0;
};

/// The factors of motion and sensor in the row of the table that begins with `name`.
std::vector<PrintedFactor> factors_in(const std::string& output, const std::string& name) {
  static const std::regex factor(R"(([0-9.]+) \[([0-9.]+), ([0-9.]+)\])");
  std::istringstream lines(output);
  std::vector<PrintedFactor> found;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(name + " ")) continue;
    for (std::sregex_iterator at(line.begin(), line.end(), factor), end; at != end; ++at)
      found.push_back({std::stod(at->str(1)), std::stod(at->str(2)), std::stod(at->str(3))});
    return found;
  }
  return found;
}

/// The factor must be within four standard errors of the truth, and known to 30 %.
void expect_holds(const PrintedFactor& factor, double truth) {
  const double half_width = std::log(factor.upper / factor.lower) / 2.0;  // two standard errors
  EXPECT_LT(std::abs(std::log(factor.value / truth)), 2.0 * half_width);
  EXPECT_LT(half_width, 0.3);
}

/// Expects that a row of a command's table has these factors on the noise of motion and sensor.
void expect_factors(const Called& called, double motion, double sensor, const char* row = "all") {
  ASSERT_EQ(called.code, 0) << called.err;
  const auto factors = factors_in(called.out, row);
  ASSERT_EQ(factors.size(), 2U) << called.out;
  expect_holds(factors[0], motion);
  expect_holds(factors[1], sensor);
}

class Tune : public Program {
 protected:
  /// Exports a drive of the ring, without its truth, and writes the study of it.
  void record_drive() {
    const Called exported =
        call({"export", "ring.ini", "-o", "drives", "--set", "scenario.loops=8", "--runs", "0:1"});
    ASSERT_EQ(exported.code, 0) << exported.err;
    write("log.ini", kTunedLog);
  }
  void give_reference(double unit = 1.0, bool states_errors = true) {
    write("drives/runs/run_0000/reference.csv",
          measured_reference(text_of("drives/truth/run_0000/reference.csv"), 0.05, unit,
                             states_errors));
  }
  Tune() {
    write("ring.ini", kTunedStudy);
    write("ring.csv", kRing);
  }
  Called tune(const std::vector<std::string>& settings,
              const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"tune", "ring.ini"};
    for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
    return call_with(words, more);
  }
};

TEST_F(Tune, FindsTheFactorsOfWrongNoiseOnMotionAndSensor) {
  const Called called = tune({"belief.sigma_speed=0.05", "belief.sigma_steer_deg=0.5",
                              "belief.sigma_range=0.14", "belief.sigma_bearing_deg=1.4"});
  ASSERT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out, testing::StartsWith("ekf_slam should assume "));
  for (const char* row : {"1", "3", "10", "all"}) expect_factors(called, 2.0, 1.0 / 1.4, row);
  EXPECT_THAT(called.out, HasSubstr("ekf_slam_tuned"));
  EXPECT_THAT(called.out, HasSubstr("60 fresh runs"));
}

TEST_F(Tune, FindsOneWhereTheNoiseIsRight) { expect_factors(tune({}), 1.0, 1.0); }

/// The value of an option in "Write motion_noise=2.057 sensor_noise=1.028".
double written(const std::string& output, const std::string& option) {
  const std::size_t at = output.find(" " + option + "=", output.find("\nWrite "));
  return at == std::string::npos ? 0.0 : std::stod(output.substr(at + option.size() + 2));
}

// The factors multiply the noise of the cell as it is. What is written is the noise of [belief].
TEST_F(Tune, MultipliesTheNoiseThatTheCellHasAlready) {
  const Called called = tune({"cells.cell=ekf_slam motion_noise=0.5"});
  const auto factors = factors_in(called.out, "all");
  ASSERT_EQ(factors.size(), 2U) << called.err;
  expect_holds(factors[0], 2.0);
  EXPECT_NEAR(written(called.out, "motion_noise") / factors[0].value, 0.5, 0.005);
  EXPECT_NEAR(written(called.out, "sensor_noise") / factors[1].value, 1.0, 0.01);
}

TEST_F(Tune, SaysTheSameOnAnyNumberOfThreads) {
  const auto output = [&](const std::vector<std::string>& how) {
    static const std::regex time(R"( +[0-9.]+\n)");
    return std::regex_replace(tune({"study.runs=24"}, how).out, time, "\n");
  };
  const std::string serial = output({"--backend", "serial"});
  EXPECT_THAT(serial, HasSubstr("should assume"));
  EXPECT_EQ(serial, output({"--threads", "2"}));
  EXPECT_EQ(serial, output({"--threads", "3", "--backend", "openmp"}));
}

TEST_F(Tune, LeavesAFactorWithoutInfluenceAsItIs) {
  const Called called = tune({"cells.cell=dead_reckoning", "belief.map=estimated",
                              "scenario.start_sigma_m=0", "scenario.start_sigma_deg=0"});
  ASSERT_EQ(called.code, 0) << called.err;
  ASSERT_EQ(factors_in(called.out, "all").size(), 1U) << called.out;
  EXPECT_THAT(called.out, HasSubstr("does not depend on the noise of sensor"));
}

TEST_F(Tune, WritesTheLandscapeAndTheConfirmingStudy) {
  const Called called = tune({"study.runs=24"}, {"-o", "found"});
  ASSERT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(text_of("found/landscape.csv"), testing::StartsWith("motion_factor,sensor_factor,"));
  EXPECT_TRUE(exists("found/figures/landscape.svg"));
  EXPECT_EQ(
      call({"gate", "found/confirmation.h5", "--cell", "ekf_slam_tuned", "--within", "9"}).code, 0);
  EXPECT_THAT(tune({"study.runs=24"}, {"-o", "found"}).err, HasSubstr("is there already"));
}

TEST_F(Tune, TakesADriveWithoutTruthByItsInnovations) {
  record_drive();
  const Called called = call({"tune", "log.ini"});
  expect_factors(called, 1.0, 2.0);
  EXPECT_THAT(called.out, HasSubstr("innovations of the second half"));
  const std::string of_map = "map = known\nstart_sigma_m = 0.1\nstart_sigma_deg = 1\n";
  write("log.ini", std::string(kTunedLog).erase(kTunedLog.find(of_map), of_map.size()));
  expect_refused({"tune", "log.ini", "--set", "cells.cell=dead_reckoning"},
                 "has the same score with any noise");
}

TEST_F(Tune, TakesADriveByItsErrorsAgainstAReference) {
  record_drive();
  give_reference();
  const Called called = call({"tune", "log.ini", "--set", "belief.sigma_speed=0.05", "--set",
                              "belief.sigma_steer_deg=0.5"});
  expect_factors(called, 2.0, 2.0);
  EXPECT_THAT(called.out, HasSubstr("errors at the fixes of reference in the first"));
  EXPECT_THAT(called.out, HasSubstr("errors against reference in the second"));
  EXPECT_THAT(call({"tune", "log.ini", "--by", "innovations"}).out,
              HasSubstr("innovations of the second half"));
}

TEST_F(Tune, SaysThatNothingConfirmsItWithoutFixesInTheSecondHalf) {
  record_drive();
  give_reference();
  const std::string name = "drives/runs/run_0000/reference.csv";
  const std::string fixes = text_of(name);
  write(name, fixes.substr(0, fixes.find('\n', fixes.size() * 9 / 20) + 1));
  const Called called = call({"tune", "log.ini"});
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out, HasSubstr("reference has too few fixes in the second half"));
  EXPECT_THAT(called.out, testing::Not(HasSubstr("plus -")));
}

TEST_F(Tune, NamesGrossOutliersOfTheReferenceFirst) {
  record_drive();
  const std::string name = "drives/runs/run_0000/reference.csv";
  const auto tune_with_fix_off_by = [&](double distance) {
    give_reference();
    std::string fixes = text_of(name);
    const std::size_t row = fixes.find('\n', fixes.size() / 4);
    const std::size_t x = fixes.find(',', row) + 1, end = fixes.find(',', x);
    const double wild = std::stod(fixes.substr(x, end - x)) + distance;
    write(name, fixes.replace(x, end - x, std::to_string(wild)));
    return call({"tune", "log.ini"});
  };
  EXPECT_THAT(tune_with_fix_off_by(2.0).out, testing::StartsWith("1 of the "));
  EXPECT_THAT(tune_with_fix_off_by(400.0).err, HasSubstr("1 of the fixes is a gross outlier"));
}

TEST_F(Tune, TakesAReferenceWithoutErrorsForExactOnlyIfItIsAskedTo) {
  record_drive();
  give_reference(1.0, false);
  EXPECT_THAT(call({"tune", "log.ini"}).out, HasSubstr("because it states no errors"));
  EXPECT_THAT(
      call({"tune", "log.ini", "--by", "reference"}).out,
      testing::AllOf(HasSubstr("counts as exact"), HasSubstr("states no errors of its own")));
}

TEST_F(Tune, RefusesAReferenceThatNoNoiseExplains) {
  record_drive();
  expect_refused({"tune", "log.ini", "--by", "reference"}, "the drive has no reference");
  expect_refused({"tune", "log.ini", "--by", "truth"}, "--by truth: no such score");
  expect_refused({"tune", "ring.ini", "--by", "innovations"}, "this study is simulated");
  for (const double unit : {0.01, 100.0}) {
    give_reference(unit);
    expect_refused({"tune", "log.ini"}, "correct unit, frame or times of the reference");
  }
}

TEST_F(Tune, TakesNoFailureForAScore) {
  const Called called = tune({"study.runs=19", "belief.map=estimated", "scenario.start_sigma_m=0",
                              "scenario.start_sigma_deg=0", "association.kind=nearest",
                              "association.most_landmarks=1"});
  EXPECT_THAT(called.err, HasSubstr("its score has no minimum near a factor of 1.00 on motion"));
  EXPECT_THAT(called.err, HasSubstr("the filter fails near by"));
}

TEST_F(Tune, RefusesWhatCannotBeTuned) {
  expect_refused({"tune", "ring.ini", "--cell", "ekf_slma"}, "did you mean ekf_slam?");
  expect_refused({"tune", "ring.ini", "--set", "study.runs=18"}, "too few to choose noise by");
  expect_refused({"tune", "ring.ini", "--seed", "1"}, "--seed 1: the seed of the study");
  expect_refused({"tune", "mine.h5"}, "mine.h5: a result, not a study");
  write("blink.csv", kBlinkWorld);
  write("ring.ini", kBlink);
  expect_refused({"tune", "ring.ini"}, "--cell CELL is needed");
  expect_refused({"tune", "ring.ini", "--set", "cells.cell=external command=cat"},
                 "cell external is a program");
}

}  // namespace
}  // namespace montecarta::experiments
