// SPDX-License-Identifier: BSD-3-Clause
// What check says of memory and disk, beside what a run takes.
#include "tests/experiments/commands/program.hpp"

#include <gtest/gtest.h>

#include <regex>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

namespace montecarta::experiments {
namespace {

using testing::HasSubstr;
using testing::Not;

class Costs : public BlinkProgram {
 protected:
  /// [byte] Memory that `check` states.
  double stated(const std::vector<std::string>& study) const {
    std::vector<std::string> words{"check"};
    words.insert(words.end(), study.begin(), study.end());
    const std::string text = call(words).out;
    std::smatch found;
    if (!std::regex_search(text, found, std::regex("memory +about ([0-9.]+) ([kMG])B"))) return 0;
    const std::string unit = found[2];
    return std::stod(found[1]) * (unit == "k" ? 1e3 : unit == "M" ? 1e6 : 1e9);
  }
  /// [byte] Largest resident memory of a run.
  double taken(std::vector<std::string> words) const {
    words.insert(words.begin(), {program_under_test(), "run"});
    words.insert(words.end(), {"-o", folder_ / "out.h5", "--quiet", "--force"});
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    pid_t process = 0;
    EXPECT_EQ(posix_spawn(&process, pointers[0], nullptr, nullptr, pointers.data(), environ), 0);
    int status = 0;
    struct rusage usage {};
    ::wait4(process, &status, 0, &usage);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
  }
};

TEST_F(Costs, SlowOfMemoryAreWithinAFifth) {
  const std::string study = "first_study", runs = "study.runs=24";
  const std::vector<std::vector<std::string>> studies = {
      {study, "--set", runs, "--threads", "1"},
      {study, "--set", runs, "--threads", "8"},
      {study, "--set", "study.runs=4", "--threads", "2", "--set",
       "cells.cell=fastslam2 particles=5000"},
      {study, "--set", runs, "--threads", "2", "--set", "cells.cell=ekf_slam", "--set",
       "record.full_runs=0"},
  };
  for (const auto& words : studies) {
    const double ratio = stated(words) / taken(words);
    EXPECT_GT(ratio, 0.8) << testing::PrintToString(words);
    EXPECT_LT(ratio, 1.2) << testing::PrintToString(words);
  }
}

TEST_F(Costs, OfTheDiskAreNamedWhereTheyAreTheLimit) {
  EXPECT_THAT(call({"check", "blink.ini", "--disk-rate", "0.0001"}).out,
              HasSubstr("written at 100 B/s (--disk-rate)"));
  EXPECT_THAT(call({"check", "blink.ini", "--disk-rate", "1e9"}).out, Not(HasSubstr("written at")));
  EXPECT_THAT(call({"check", "first_study"}).out, Not(HasSubstr("written at")));
}

}  // namespace
}  // namespace montecarta::experiments
