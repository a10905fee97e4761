// SPDX-License-Identifier: BSD-3-Clause
// Workers that share a folder: each case ends with the bits of one machine.
#include "engine/records/result_file.hpp"
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

/// [s] So long that a test which waits for it fails by its time limit.
constexpr const char* kForever = "100000";

class SharedFolder : public BlinkProgram {
 protected:
  /// The first call of a worker, which makes the folder `f`.
  static std::vector<std::string> first(const std::string& shards = "4") {
    return {"work",          "f",         "--study", "blink.ini",  "--shards", shards, "--set",
            "study.runs=12", "--threads", "1",       "--patience", kForever};
  }
  Called work(const std::string& patience = kForever,
              const std::vector<std::string>& more = {}) const {
    return call_with({"work", "f", "--patience", patience}, more);
  }
  /// Makes the folder and its plan. Every shard remains to be computed.
  void lay_out() const { ASSERT_EQ(call_with(first(), {"--time-budget", "0.001"}).code, 85); }
  void expect_the_bits_of_one_machine() const {
    ASSERT_EQ(call({"run", "blink.ini", "-o", "one.h5", "--quiet", "--set", "study.runs=12"}).code,
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
  std::vector<std::string> words = first("2");
  words.back() = "0.1";
  for (const char* seconds : {"0.02", "0.05", "0.1", "0.2"})
    call(words, std::string("timeout -s KILL ") + seconds + " ");
  EXPECT_EQ(call(words).code, 0);
  expect_the_bits_of_one_machine();
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
  EXPECT_THAT(work().err, HasSubstr("shard_0001.h5"));
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

TEST_F(SharedFolder, RefusesAStudyWhoseShardsCannotDecideWhenToStop) {
  expect_refused({"work", "f", "--study", "blink.ini", "--shards", "2", "--set",
                  "study.until=position_rmse < 1"},
                 "until");
  EXPECT_FALSE(exists("f"));
}

}  // namespace
}  // namespace montecarta::experiments
