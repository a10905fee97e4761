// SPDX-License-Identifier: BSD-3-Clause
// verify and replay, which compute stored runs again.
#include "engine/records/check_file.hpp"
#include "engine/records/h5.hpp"
#include "engine/records/result_file.hpp"
#include "engine/records/result_layout.hpp"
#include "experiments/text/words.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/experiments/commands/program.hpp"

namespace montecarta::experiments {
namespace {

class Verify : public BlinkProgram {
 protected:
  Verify() : BlinkProgram(kBlink + "cell = marginal particles=5\n") {}
  void run(const std::vector<std::string>& more) const {
    ASSERT_EQ(call_with({"run", "blink.ini", "-o", "out.h5", "--quiet"}, more).code, 0);
    std::filesystem::remove(folder_ / "blink.ini");
    std::filesystem::remove(folder_ / "blink.csv");  // the file alone must do
  }
  /// Turns one byte of run index `run` of a cell's column into another.
  void alter(const std::string& label, const std::string& column, std::size_t run) const {
    const std::filesystem::path path = folder_ / "out.h5";
    const ResultDescription file = read_description(path);
    const auto cell = std::ranges::find(file.cells, label, &StoredCell::label);
    const auto found = std::ranges::find(cell->columns, column, &Column::name);
    const ResultSlabs slabs = find_slabs(path, file);
    const Slab& slab = slabs.cells[static_cast<std::size_t>(cell - file.cells.begin())]
                           .columns[static_cast<std::size_t>(found - cell->columns.begin())];
    engine::flip_bit(path, slab.at(run));
  }
};

TEST_F(Verify, ShardsAndRowsAtScansOnly) {
  run({"--runs", "1:3", "--set", "record.rate=scan", "--set", "record.columns=pose"});
  EXPECT_THAT(call({"verify", "out.h5", "--sample", "5", "--seed", "17"}).out,
              StartsWith("5 of 5 runs are reproduced byte for byte, out of 6 stored (sample 17)"));
}

TEST_F(Verify, RunsWithLandmarksOfTheirOwn) {
  run({"--set", "scenario.map=random", "--set", "scenario.map_shift=1"});
  EXPECT_THAT(call({"verify", "out.h5", "--sample", "100"}).out, StartsWith("9 of 9 runs"));
  const std::filesystem::path path = folder_ / "out.h5";
  const ResultSlabs slabs = find_slabs(path, read_description(path));
  engine::flip_bit(path, slabs.truth->landmarks->at(1));
  const Called called = call({"verify", "out.h5", "--sample", "100"});
  EXPECT_EQ(called.code, 4);
  EXPECT_THAT(called.out, HasSubstr("run 1: true landmark differs in 1 of 4 numbers"));
}

TEST_F(Verify, AFileAloneIsEnoughAndOneAlteredBitIsFoundWithExitCode4) {
  run({});
  EXPECT_THAT(call({"verify", "out.h5", "--sample", "100"}).out,
              StartsWith("9 of 9 runs are reproduced byte for byte, out of 9"));
  alter("fastslam2_m10", "ess", 2);
  const Called called = call({"verify", "out.h5", "--sample", "9"});
  EXPECT_EQ(called.code, 4) << called.err;
  EXPECT_THAT(called.out, AllOf(StartsWith("fastslam2_m10, run 2: ess differs in 1 of "),
                                HasSubstr("first at (scan 0): stored "), HasSubstr("fingerprint"),
                                HasSubstr("\n8 of 9 runs")));
  EXPECT_EQ(
      call({"replay", "out.h5", "--cell", "fastslam2_m10", "--run", "2", "-o", "two.h5"}).code, 4);
  EXPECT_EQ(
      call({"replay", "out.h5", "--cell", "fastslam2_m10", "--run", "1", "-o", "one.h5"}).code, 0);
}

TEST_F(Verify, WrongInputIsNamed) {
  run({});
  const auto refused = [&](const std::string& cell, const std::string& number,
                           const std::string& output, const std::string& words) {
    expect_refused({"replay", "out.h5", "--cell", cell, "--run", number, "-o", output}, words);
  };
  EXPECT_EQ(call({"verify", "out.h5", "--sample", "0"}).code, 2);
  refused("fastslam2_m1", "1", "one.h5", "did you mean fastslam2_m10?");
  refused("ekf_slam", "3", "one.h5", "from 0 to 2");
  refused("ekf_slam", "1", "out.h5", "out.h5");
  expect_refused({"replay", "out.h5", "--cell", "ekf_slam", "--run", "1"}, "-o ONE.h5 is missing");
  EXPECT_FALSE(exists("one.h5"));
}

TEST_F(Verify, AReplayHoldsEverythingAndTheSameNumbers) {
  run({"--set", "record.columns=pose", "--set", "record.rate=scan"});
  const Called called =
      call({"replay", "out.h5", "--cell", "fastslam2_m10", "--run", "2", "-o", "one.h5"});
  ASSERT_EQ(called.code, 0) << called.err;
  const ResultFile stored(folder_ / "out.h5"), replayed(folder_ / "one.h5");
  const StoredCell& cell = replayed.cells().front();
  EXPECT_EQ(replayed.cells().size(), 1U);
  EXPECT_EQ(replayed.runs(), std::vector<std::uint64_t>{2});
  for (const char* column : {"pose_mean", "pose_covariance", "ancestor", "particle_pose",
                             "log_weight", "association_wrong", "map_mean", "final_map_seen"})
    EXPECT_TRUE(cell.has(column)) << column;
  EXPECT_GT(replayed.times().size(), stored.times().size());
  std::vector<double> before(stored.scan_times().size()), again(before.size());
  stored.read(stored.cells().at(1), "ess", 2, before);
  replayed.read(cell, "ess", 0, again);
  EXPECT_EQ(stored.cells().at(1).label, cell.label);
  EXPECT_EQ(before, again);
}

TEST_F(Verify, ARecordedDriveIsFoundByDataOrMissedByName) {
  std::filesystem::create_directories(folder_ / "here/drive");
  write("here/drive/start.csv", "time_s,x_m,y_m,heading_rad\n0,0,0,0\n");
  write("here/drive/odometry.csv", "time_s,speed_mps,steer_rad\n0,1,0\n1,1,0.1\n2,1,0\n");
  write("here/drive/detections.csv", "time_s,range_m,bearing_rad\n0.5,5,0.2\n1.5,4,0.3\n");
  write("here/drive/reference.csv", "time_s,x_m,y_m\n0.5,0.5,0\n1.5,1.5,0\n");
  write("here/log.ini",
        "[study]\nname = log\nruns = 2\n[scenario]\nkind = log\npath = drive\n[belief]\nwheelbase "
        "= 2\n"
        "sigma_speed = 0.1\nsigma_steer_deg = 1\nsigma_range = 0.1\nsigma_bearing_deg = 1\n"
        "[cells]\ncell = fastslam2 particles=10\n");
  const Called ran = call({"run", "here/log.ini", "-o", "log.h5", "--quiet"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Called lost = call({"verify", "log.h5"});
  EXPECT_EQ(lost.code, 2);
  EXPECT_THAT(lost.err, AllOf(HasSubstr("log.h5 (the study in it)"), HasSubstr("MONTECARTA_DATA")));
  EXPECT_EQ(call({"verify", "log.h5", "--data", "here/drive"}).code, 0);
  const Called replayed = call({"replay", "log.h5", "--cell", "fastslam2_m10", "--run", "0", "-o",
                                "one.h5", "--data", "here/drive"});
  EXPECT_EQ(replayed.code, 0) << replayed.err;
}

// Programs that a study names start only if the user allows it, and verify checks them.

class ExternalCommands : public Program {
 protected:
  ExternalCommands() { write("blink.csv", kBlinkWorld); }
  /// A study with a cell that runs the scripted program.
  void write_study(const std::string& arguments, const std::string& options = "") const {
    write("study.ini", kBlink + "cell = external command=" +
                           in_quotes(MONTECARTA_SCRIPTED_PROGRAM " " + arguments) + " label=mine " +
                           options + "\n");
  }
  Called run(const std::vector<std::string>& more) const {
    return call_with({"run", "study.ini", "-o", "out.h5", "--quiet"}, more);
  }
};

TEST_F(ExternalCommands, NothingIsStartedUnasked) {
  write_study("orphan 0 started");
  const Called refused = run({});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("study.ini:"), HasSubstr("scripted_program orphan"),
                                 HasSubstr("add --allow-external")));
  EXPECT_FALSE(exists("out.h5.part"));
  const Called checked = call({"check", "study.ini"});
  EXPECT_EQ(checked.code, 0);
  EXPECT_THAT(checked.out, testing::ContainsRegex("mine +\\? "));  // nobody knows how long
  EXPECT_FALSE(exists("started"));
  ASSERT_EQ(run({"--allow-external"}).code, 0);
  ASSERT_TRUE(exists("started"));
  std::filesystem::remove(folder_ / "started");
  EXPECT_THAT(call({"verify", "out.h5"}).err, HasSubstr("add --allow-external"));
  EXPECT_EQ(call({"replay", "out.h5", "--cell", "mine", "--run", "1", "-o", "one.h5"}).code, 2);
  EXPECT_EQ(call({"replay", "out.h5", "--cell", "ekf_slam", "--run", "1", "-o", "one.h5"}).code, 0);
  EXPECT_EQ(call({"analyze", "out.h5"}).code, 0);
  EXPECT_EQ(call({"report", "out.h5", "-o", "page"}).code, 0);
  EXPECT_FALSE(exists("started"));
  EXPECT_EQ(call({"check", "study.ini", "--allow-external"}).code, 0);
  EXPECT_TRUE(exists("started"));
}

TEST_F(ExternalCommands, VerifyTellsWhetherAProgramIsDeterministic) {
  write_study("");
  ASSERT_EQ(run({"--allow-external"}).code, 0);
  EXPECT_EQ(call({"verify", "out.h5", "--sample", "9", "--allow-external"}).code, 0);
  EXPECT_EQ(
      call({"replay", "out.h5", "--cell", "mine", "--run", "2", "-o", "one.h5", "--allow-external"})
          .code,
      0);
}

TEST_F(ExternalCommands, VerifyFindsWhatAProgramKeepsFromRunToRun) {
  write_study("count");
  ASSERT_EQ(run({"--allow-external", "--threads", "1"}).code, 0);
  const Called verified = call({"verify", "out.h5", "--sample", "9", "--allow-external"});
  EXPECT_EQ(verified.code, 4);
  EXPECT_THAT(verified.out, HasSubstr("mine, run 2: pose_mean differs"));
}

TEST_F(ExternalCommands, AStopEndsTheWaitAndIsNoFailure) {
  write("study.ini", kBlink);
  const std::string cell = "external command=" + in_quotes(MONTECARTA_SCRIPTED_PROGRAM " hang 0");
  const Called stopped = run({"--allow-external", "--time-budget", "0.2", "--set",
                              "cells.cell=" + cell + " answer_limit=86400"});  // a day
  EXPECT_EQ(stopped.code, 85) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("3 runs are missing"));
  EXPECT_THAT(stopped.err, HasSubstr("--allow-external"));
}

TEST_F(ExternalCommands, FailedRunsAreAResult) {
  write_study("exit 2");
  EXPECT_EQ(run({"--allow-external"}).code, 3);
  EXPECT_THAT(call({"analyze", "out.h5"}).out, HasSubstr("exit code 7: last words"));
}

}  // namespace
}  // namespace montecarta::experiments
