// SPDX-License-Identifier: BSD-3-Clause
// Drives for anyone's estimator.
#include "experiments/drives/simulated_drive.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/recordings/recorded_drive.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/study/make_drives.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/experiments/commands/program.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <bit>

namespace montecarta::experiments {
namespace {

std::vector<std::uint64_t> bits_of(const Itinerary& itinerary, const Drive& drive) {
  std::vector<std::uint64_t> bits;
  const auto add = [&](auto... numbers) {
    (bits.push_back(std::bit_cast<std::uint64_t>(static_cast<double>(numbers))), ...);
  };
  add(itinerary.start.x, itinerary.start.y, itinerary.start.heading);
  for (const double time : itinerary.step_time) add(time);
  for (const std::uint32_t step : itinerary.scan_step) add(step);
  for (const Control& control : drive.controls) add(control[0], control[1]);
  for (const std::uint32_t begin : drive.scan_begin) add(begin);
  for (const Detection& d : drive.detections) add(d[0], d[1], d.identity);
  return bits;
}

class Export : public BlinkProgram {
 protected:
  Called run_export(const std::vector<std::string>& more = {}) const {
    return call_with({"export", "blink.ini", "-o", "drives"}, more);
  }
  /// The drive of a run in its exported log, with the truth beside the data for an estimator.
  RecordedDrive exported(const std::string& run) const {
    for (const auto& file : std::filesystem::directory_iterator(folder_ / "drives/truth" / run))
      std::filesystem::copy(file.path(), folder_ / "drives/runs" / run);
    return {read_log_csv(folder_ / "drives/runs" / run), {1e6}, 0.0};
  }
};

// Law: an exported log is the drive, to the bit.
TEST_F(Export, ALogReadBackIsTheSameDrive) {
  for (const char* noise : {"matched", "measured-control"}) {
    const std::vector<std::string> overrides = {std::string("scenario.noise=") + noise,
                                                "scenario.clutter_rate=2", "scenario.map=random",
                                                "scenario.start_heading_deg=-7"};
    std::vector<std::string> words;
    for (const std::string& text : overrides) words.insert(words.end(), {"--set", text});
    const Called called = run_export(words);
    ASSERT_EQ(called.code, 0) << called.err;
    const Study study = read_study(folder_ / "blink.ini", known_filters(), overrides);
    const auto drives = drives_of(study, study.settings.count("study", "seed"));
    Drive simulated, read;
    for (const std::uint64_t run : {0, 2}) {
      drives->generate(run, simulated);
      const RecordedDrive log = exported("run_000" + std::to_string(run));
      log.generate(0, read);
      EXPECT_EQ(bits_of(drives->itinerary(), simulated), bits_of(log.itinerary(), read));
      const ReferencePath& truth = log.itinerary().references.front();
      ASSERT_EQ(truth.time, drives->itinerary().step_time);
      for (std::size_t k = 0; k < simulated.truth.size(); ++k) {
        EXPECT_EQ(truth.position[k].x(), simulated.truth[k].x);
        EXPECT_EQ(truth.heading[k], simulated.truth[k].heading);
      }
      EXPECT_EQ(log.itinerary().landmarks, own_landmarks_of(study, 1)(run));
    }
    std::filesystem::remove_all(folder_ / "drives");
  }
}

TEST_F(Export, AnEstimatorSeesNoTruth) {
  ASSERT_EQ(run_export({"--set", "association.kind=nearest", "--runs", "1:2"}).code, 0);
  EXPECT_FALSE(exists("drives/runs/run_0000"));
  EXPECT_FALSE(exists("drives/runs/run_0001/reference.csv"));
  EXPECT_FALSE(exists("drives/runs/run_0001/landmarks.csv"));
  EXPECT_TRUE(exists("drives/truth/run_0001/reference.csv"));
  EXPECT_TRUE(exists("drives/truth/study.ini"));
  EXPECT_THAT(text_of("drives/runs/run_0001/detections.csv"), Not(HasSubstr("identity")));
  const auto belief = settings_in(text_of("drives/belief.ini"));
  EXPECT_EQ(belief.at("belief.sigma_range"), "0.1");
  EXPECT_FALSE(belief.contains("world.landmark"));
}

TEST_F(Export, AnEstimatorIsGivenAKnownMapAndStartWithTheirErrors) {
  const std::vector<std::string> overrides = {"belief.map=known", "scenario.map_sigma_m=0.5",
                                              "scenario.start_sigma_m=2", "cells.cell=ekf_slam"};
  std::vector<std::string> words = {"--runs", "1:2"};
  for (const std::string& setting : overrides) words.insert(words.end(), {"--set", setting});
  ASSERT_EQ(run_export(words).code, 0);
  const Study study = read_study(folder_ / "blink.ini", known_filters(), overrides);
  Drive drive;
  drives_of(study, study.settings.count("study", "seed"))->generate(1, drive);
  std::filesystem::copy(folder_ / "drives/truth/run_0001/reference.csv",
                        folder_ / "drives/runs/run_0001/reference.csv");
  const DriveLog given = read_log_csv(folder_ / "drives/runs/run_0001");
  EXPECT_EQ(boxminus(given.start, drive.prior->pose.mean).norm(), 0.0);
  ASSERT_EQ(given.landmarks.size(), study.world.landmarks.size());
  for (std::size_t k = 0; k < given.landmarks.size(); ++k) {
    EXPECT_EQ(given.landmarks[k], drive.prior->map[k].mean);
    EXPECT_NE(given.landmarks[k], study.world.landmarks[k]);
  }
  const auto belief = settings_in(text_of("drives/belief.ini"));
  EXPECT_EQ(belief.at("belief.map"), "known");
  EXPECT_EQ(belief.at("belief.map_sigma_m"), "0.5");
}

TEST_F(Export, RefusesFixesThatALogCannotHold) {
  const std::vector<std::string> words = {"--set", "cells.cell=ekf_slam", "--set",
                                          "scenario.fixes=position"};
  const Called refused = run_export(words);
  EXPECT_NE(refused.code, 0);
  EXPECT_THAT(refused.err, testing::HasSubstr("--set scenario.fixes=none"));
  EXPECT_FALSE(exists("drives"));
}

TEST_F(Export, WrongInputIsNamed) {
  ASSERT_EQ(run_export().code, 0);
  expect_refused({"export", "blink.ini", "-o", "drives"}, "drives: not a new folder");
  EXPECT_EQ(call({"export", "blink.ini"}).code, 2);
}

class Compare : public BlinkProgram {
 protected:
  void SetUp() override {
    ASSERT_EQ(call({"run", "blink.ini", "-o", "out.h5", "--quiet"}).code, 0);
  }
};

TEST_F(Compare, SaysWhatEachCellHasMoreThanTheBaseline) {
  const Called called = call({"compare", "out.h5", "--baseline", "ekf_slam", "--csv", "tables"});
  EXPECT_EQ(called.code, 0) << called.err;
  const Called detailed = call({"compare", "out.h5", "--baseline", "ekf_slam", "--all"});
  for (const char* words :
       {"position_rmse [m]", "heading_rmse [rad]", "NEES ratio", "cpu_seconds [s]"}) {
    EXPECT_THAT(called.out, HasSubstr(words));
    EXPECT_THAT(detailed.out, HasSubstr(words));
  }
  for (const char* words : {"row beats", "Holm"}) {
    EXPECT_THAT(called.out, testing::Not(HasSubstr(words)));
    EXPECT_THAT(detailed.out, HasSubstr(words));
  }
  EXPECT_THAT(text_of("tables/comparison.csv"), StartsWith("metric,units,cell,baseline,verdict,"));
  EXPECT_THAT(text_of("tables/wins.csv"), HasSubstr("\nposition_rmse,fastslam2_m10,ekf_slam,"));
  expect_refused({"compare", "out.h5", "--baseline", "ekf_slam", "--csv", "tables"},
                 "comparison.csv: is there already");
}

TEST_F(Compare, NamesTheNearestSpelling) {
  const std::vector<std::string> words = {"compare", "out.h5", "--baseline", "ekf_slam",
                                          "--metric"};
  expect_refused({"compare", "out.h5", "--baseline", "ekf_slan"}, "did you mean ekf_slam?");
  expect_refused({"compare", "out.h5"}, "--baseline CELL");
  EXPECT_THAT(call_with(words, {"postion_rmse"}).err, HasSubstr("did you mean position_rmse?"));
  const std::string both = call_with(words, {"position_error, nees"}).out;
  EXPECT_THAT(both, HasSubstr("position_error [m]"));
  EXPECT_THAT(both, testing::Not(HasSubstr("heading_rmse")));
  EXPECT_THAT(call_with(words, {"ess"}).out, HasSubstr("ess: nothing to compare"));
}

}  // namespace
}  // namespace montecarta::experiments
