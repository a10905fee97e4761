// SPDX-License-Identifier: BSD-3-Clause
// Workers that share a folder: each case ends with the bits of one machine.
#include "engine/records/posix_file.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/commands/shard_folder.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/study/study.hpp"
#include "tests/doubles/same_results.hpp"
#include "tests/experiments/commands/program.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

namespace montecarta::experiments {
namespace {

using testing::HasSubstr;
using testing::Not;

/// [s] So long that a test which waits for it fails by its time limit.
constexpr const char* kForever = "100000";

class SharedFolder : public BlinkProgram {
 protected:
  /// The first call of a worker, which makes the folder `f`.
  static std::vector<std::string> first(const std::string& shards = "4",
                                        const std::string& runs = "12") {
    return {"work",      "f",    "--study",    "blink.ini",
            "--shards",  shards, "--set",      "study.runs=" + runs,
            "--threads", "1",    "--patience", kForever};
  }
  Called work(const std::string& patience = kForever,
              const std::vector<std::string>& more = {}) const {
    return call_with({"work", "f", "--patience", patience}, more);
  }
  /// What cluster/status prints.
  std::string status() const {
    const std::string line = "cd " + shell_quoted(folder_.string()) +
                             " && MONTECARTA=" + shell_quoted(program_under_test()) +
                             " python3 -B " MONTECARTA_SOURCE_DIR "/cluster/status f >told 2>&1";
    EXPECT_EQ(std::system(line.c_str()), 0);
    return text_of("told");
  }
  /// Makes the folder and its plan. Every shard remains to be computed.
  void lay_out() const {
    const std::vector<std::string> twelve = {"study.runs=12"};
    const Study study = read_study(folder_ / "blink.ini", known_filters(), twelve);
    ShardFolder::make(folder_ / "f", study,
                      {.runs = 12,
                       .cells = study.cells.size(),
                       .shards = 4,
                       .program = program_under_test(),
                       .settings = settings_beside_text(study)});
  }
  void expect_the_bits_of_one_machine(const std::string& runs = "12") const {
    ASSERT_EQ(
        call({"run", "blink.ini", "-o", "one.h5", "--quiet", "--set", "study.runs=" + runs}).code,
        0);
    ASSERT_TRUE(exists("f/result.h5"));
    EXPECT_EQ(difference(ResultFile(folder_ / "f/result.h5"), ResultFile(folder_ / "one.h5")), "");
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "f")) {
      const std::string name = entry.path().filename().string();
      const bool is_of_work = name.find(".h5.") != name.npos;  // .part.*, .claim.*
      EXPECT_FALSE(is_of_work) << name;
    }
  }
};

TEST_F(SharedFolder, OfOneWorkerHoldsTheResultAndTheVerdictIsPrinted) {
  const Called called = call(first());
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out, HasSubstr("ekf_slam is"));
  expect_the_bits_of_one_machine();
  const Called again = call(first());
  EXPECT_EQ(again.code, 0);
  EXPECT_EQ(again.out, "");
}

TEST_F(SharedFolder, OfManyWorkersIsMergedOnce) {
  std::vector<std::thread> workers;
  std::vector<int> codes(5, -1);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    workers.emplace_back([&, i] {
      std::string line = "cd '" + folder_.string() + "' && '" + program_under_test() + "'";
      for (const std::string& word : first("12")) line += " " + word;
      codes[i] = std::system((line + " >out" + std::to_string(i) + " 2>&1").c_str());
    });
  }
  for (std::thread& worker : workers) worker.join();
  int merges = 0;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const std::string said = text_of("out" + std::to_string(i));
    EXPECT_EQ(codes[i], 0) << said;
    merges += said.find("shards merged") != said.npos ? 1 : 0;
  }
  EXPECT_EQ(merges, 1);
  expect_the_bits_of_one_machine();
}

TEST_F(SharedFolder, IsContinuedAtOnceAfterACheckpoint) {
  lay_out();
  EXPECT_TRUE(exists("f/plan.json"));
  EXPECT_FALSE(exists("f/result.h5"));
  EXPECT_EQ(work().code, 0);
  expect_the_bits_of_one_machine();
}

TEST_F(SharedFolder, LosesNothingToWorkersThatDied) {
  lay_out();
  for (const char* file : {"shards/shard_0002.h5", "result.h5"})
    write("f/" + std::string(file) + ".claim.1", "at work: ghost 17 42\n");
  EXPECT_EQ(work("0.1").code, 0);
  expect_the_bits_of_one_machine();
}

TEST_F(SharedFolder, LosesNothingToKill9) {
  std::vector<std::string> words = first("2", "2000");
  words.back() = "0.1";
  int kills = 0;
  for (const char* begun : {"f/shards/*.claim.1", "f/shards/*.part.*", "f/shards/*.claim.2"})
    kills += is_killed_at(begun, words);
  EXPECT_GT(kills, 0) << text_of("killed.out");
  const Called called = call(words);
  EXPECT_EQ(called.code, 0) << called.err;
  expect_the_bits_of_one_machine("2000");
}

TEST_F(SharedFolder, LeavesAShardToALivingWorker) {
  lay_out();
  for (const char* number : {"1", "2", "3", "4"})  // the last worker that may be lost over it
    write("f/shards/shard_0001.h5.claim." + std::string(number), "failed on ghost 17: its reason");
  const std::filesystem::path claim = folder_ / "f/shards/shard_0001.h5.claim.5";
  std::ofstream file(claim);
  file << "at work: other 17 0" << std::flush;
  std::atomic<bool> is_over = false;
  std::thread other([&] {
    for (int sign = 1000; !is_over; ++sign) {
      file.seekp(0);
      file << "at work: other 17 " << sign << std::flush;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  const Called called = work();
  is_over = true;
  other.join();
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.err, HasSubstr("the last one merges"));
  EXPECT_TRUE(exists("f/shards/shard_0000.h5"));
  EXPECT_FALSE(exists("f/shards/shard_0001.h5"));
  EXPECT_FALSE(exists("f/result.h5"));
}

TEST_F(SharedFolder, GivesUpAShardThatEndsAllWorkers) {
  lay_out();
  for (int i = 1; i <= 5; ++i)
    write("f/shards/shard_0003.h5.claim." + std::to_string(i), "failed on ghost 17: its reason\n");
  const Called called = work("0.1");
  EXPECT_EQ(called.code, 1);
  EXPECT_THAT(called.err, HasSubstr("shard_0003.h5.claim.*: failed on ghost 17: its reason"));
  const std::string told = status();
  EXPECT_THAT(told, HasSubstr("3 done, 1 failed of 4"));
  EXPECT_THAT(told, HasSubstr("failed  shard 3: failed on ghost 17: its reason"));
  EXPECT_TRUE(exists("f/shards/shard_0002.h5"));
  for (int i = 1; i <= 5; ++i)
    std::filesystem::remove(folder_ / ("f/shards/shard_0003.h5.claim." + std::to_string(i)));
  EXPECT_EQ(work().code, 0);
  expect_the_bits_of_one_machine();
}

TEST_F(SharedFolder, SaysWhichShardIsDamagedAndComputesItAgain) {
  ASSERT_EQ(call(first()).code, 0);
  std::filesystem::remove(folder_ / "f/result.h5");
  std::filesystem::resize_file(folder_ / "f/shards/shard_0001.h5", 5000);
  for (int worker = 0; worker < 7; ++worker) {  // a loss of none of them
    EXPECT_THAT(work().err, HasSubstr("shard_0001.h5"));
    EXPECT_THAT(text_of("stderr"), Not(HasSubstr("were lost")));
  }
  std::filesystem::remove(folder_ / "f/shards/shard_0001.h5");
  EXPECT_EQ(work().code, 0);
  expect_the_bits_of_one_machine();
}

TEST_F(SharedFolder, IsRefusedWhereItHoldsSomethingElse) {
  expect_refused({"work", "f"}, "--study STUDY.ini --shards N");
  expect_refused({"work", "f", "--study", "blink.ini"}, "add the other");
  expect_refused({"work", "f", "--study", "blink.ini", "--shards", "4"}, "choose 1 to 3");
  EXPECT_FALSE(exists("f"));
  lay_out();
  std::vector<std::string> words = first();
  words[5] = "3";
  expect_refused(words, "--shards 4, or another folder");
  words = first();
  words[7] = "study.runs=13";
  expect_refused(words, "holds another study");
  write("f/plan.json", "{}");
  expect_refused({"work", "f"}, "work in another folder");
}

TEST_F(SharedFolder, IsContinuedWhereThePlanWasNotWritten) {
  lay_out();
  std::filesystem::remove(folder_ / "f/plan.json");
  std::vector<std::string> other = first();
  other[7] = "study.runs=13";
  expect_refused(other, "move it away");
  EXPECT_FALSE(exists("f/plan.json"));
  EXPECT_EQ(call(first()).code, 0);
  expect_the_bits_of_one_machine();
}

/// Two recorded drives, each with its own speed, that the study names without their folder.
TEST_F(SharedFolder, KeepsWhereRecordedDrivesAre) {
  for (const std::string drive : {"monday", "tuesday"}) {
    std::filesystem::create_directories(folder_ / "data" / drive);
    const std::string speed = drive == "monday" ? "0.3" : "0.4", in = "data/" + drive + "/";
    write(in + "start.csv", "time_s,x_m,y_m,heading_rad\n0,0,0,0\n");
    write(in + "odometry.csv",
          "time_s,speed_mps,yaw_rate_radps\n0," + speed + ",0\n1," + speed + ",0\n");
    write(in + "reference.csv", "time_s,x_m,y_m,heading_rad\n1," + speed + ",0,0\n");
    write(in + "detections.csv", "time_s,range_m,bearing_rad,identity\n0.5,5,0,0\n1,5,0,0\n");
  }
  write("week.ini",
        "[study]\nname = week\nruns = 2\n[scenario]\nkind = log\npath = monday, tuesday\n"
        "max_range = 100\n[belief]\nvehicle = differential_drive\nsigma_speed = 0.02\n"
        "sigma_yaw_rate_deg = 0.5\nsigma_range = 0.1\nsigma_bearing_deg = 1\n"
        "[cells]\ncell = dead_reckoning\n");
  const std::string data = "export MONTECARTA_DATA=data && ";
  EXPECT_EQ(call({"check", "week.ini", "--drives"}, data).out,
            "scenario.path=" + (folder_ / "data/monday").string() + ", " +
                (folder_ / "data/tuesday").string() + "\n");
  const Called made = call({"work", "f", "--study", "week.ini", "--shards", "2"}, data);
  EXPECT_EQ(made.code, 0) << made.err;
  std::filesystem::remove(folder_ / "f/result.h5");
  std::filesystem::remove(folder_ / "f/shards/shard_0001.h5");
  const Called again = work();
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_TRUE(exists("f/result.h5"));
}

/// A study that stores sums over a group of runs.
class SharedGroup : public BlinkProgram {
 protected:
  SharedGroup() : BlinkProgram(kBlink + "[record]\ncolumns = sums\nrate = scan\n") {}
  static std::vector<std::string> attempt() {
    return {"run", "blink.ini", "-o", "out.h5", "--set", "study.runs=40", "--attempt", "--quiet"};
  }
};

TEST_F(SharedGroup, IsMadeThoughAnotherAttemptIsAtIt) {
  std::filesystem::create_directory(folder_ / "out.h5.groups");
  const PosixFile lock(folder_ / "out.h5.groups/lock", PosixFile::Mode::create);
  lock.lock();
  const PosixFile rows(folder_ / "out.h5.groups/rows_0.h5.part", PosixFile::Mode::create);
  rows.lock();
  const Called called = call(attempt());
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_FALSE(exists("out.h5.groups"));
  EXPECT_EQ(call({"analyze", "out.h5"}).code, 0);
}

TEST_F(SharedGroup, IsMadeByManyAttemptsAtOnce) {
  std::vector<std::thread> attempts;
  std::vector<int> codes(4, -1);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    attempts.emplace_back([&, i] {
      std::string line = "cd '" + folder_.string() + "' && '" + program_under_test() + "'";
      for (const std::string& word : attempt()) line += " " + word;
      codes[i] = std::system((line + " >out" + std::to_string(i) + " 2>&1").c_str());
    });
  }
  for (std::thread& thread : attempts) thread.join();
  for (std::size_t i = 0; i < codes.size(); ++i)
    EXPECT_EQ(codes[i], 0) << text_of("out" + std::to_string(i));
  EXPECT_EQ(call({"analyze", "out.h5"}).code, 0);
  EXPECT_FALSE(exists("out.h5.groups"));
}

TEST_F(SharedFolder, RefusesAStudyWhoseShardsCannotDecideWhenToStop) {
  expect_refused({"work", "f", "--study", "blink.ini", "--shards", "2", "--set",
                  "study.until=position_rmse < 1"},
                 "until");
  EXPECT_FALSE(exists("f"));
}

}  // namespace
}  // namespace montecarta::experiments
