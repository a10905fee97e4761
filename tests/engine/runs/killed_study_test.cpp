// SPDX-License-Identifier: BSD-3-Clause
// A study in a process of its own, killed in the middle and resumed.
#include "engine/runs/monte_carlo.hpp"
#include "tests/doubles/same_results.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_study.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <spawn.h>
#include <sys/wait.h>
#include <thread>
#include <vector>

namespace montecarta::engine {
namespace {

using std::chrono::milliseconds;

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kRuns = 16;
constexpr int kPace = 8000;  // [us] a step: a study of some 5 s on two threads, if not stopped

/// A process running the scripted study.
class Child {
 public:
  Child(const std::filesystem::path& output, int pace, std::vector<std::string> more = {},
        std::vector<std::string> environment = {}) {
    std::vector<std::string> words{MONTECARTA_SCRIPTED_STUDY, output, std::to_string(kRuns),
                                   std::to_string(pace)};
    words.insert(words.end(), more.begin(), more.end());
    if (posix_spawn(&process_, words[0].c_str(), nullptr, nullptr, pointers(words).data(),
                    pointers(environment).data()) != 0)
      throw std::runtime_error("cannot start " + words[0]);
  }
  void send(int signal) const { kill(process_, signal); }
  /// Exit code, or minus the signal that ended it.
  int wait() const {
    int status = 0;
    waitpid(process_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  static std::vector<char*> pointers(std::vector<std::string>& words) {
    std::vector<char*> result;
    for (std::string& word : words) result.push_back(word.data());
    result.push_back(nullptr);
    return result;
  }
  pid_t process_ = 0;
};

/// Runs stored so far in an unfinished file.
std::size_t stored(const std::filesystem::path& part) {
  const ResultFile file(part);
  std::size_t count = 0;
  for (const StoredCell& cell : file.cells())
    for (const RunStatus status : file.status(cell)) count += status != RunStatus::missing;
  return count;
}

class KilledStudy : public testing::Test {
 protected:
  /// Waits until some runs are stored.
  void wait_until_under_way() const {
    const auto give_up = Clock::now() + std::chrono::minutes(1);
    while (Clock::now() < give_up) {
      if (std::filesystem::exists(part) && stored(part) >= 3) return;
      std::this_thread::sleep_for(milliseconds(5));
    }
    FAIL() << "the study does not get under way";
  }
  /// Goes on in another process and compares with a study nobody killed.
  void expect_resumes_to_the_same_bits() const {
    EXPECT_EQ(Child(output, 0, {"--resume"}).wait(), 3) << "run 3 fails by script";
    const std::filesystem::path whole = folder / "whole.h5";
    run_study(scripted_cells(kRuns), {.output = whole, .progress = ProgressStyle::none});
    EXPECT_EQ(difference(ResultFile(whole), ResultFile(output)), "");
  }

  const ScratchFolder folder;
  const std::filesystem::path output = folder / "study.h5";
  const std::filesystem::path part = folder / "study.h5.part";
};

TEST_F(KilledStudy, LosesNothingToKill9) {
  const Child child(output, kPace);
  wait_until_under_way();
  child.send(SIGKILL);
  EXPECT_EQ(child.wait(), -SIGKILL);
  EXPECT_GE(stored(part), 3U);
  EXPECT_LT(stored(part), 2 * kRuns);
  expect_resumes_to_the_same_bits();
}

TEST_F(KilledStudy, StopsAtACheckpointWhenAskedByAScheduler) {
  for (const bool under_scheduler : {true, false}) {
    std::filesystem::remove(part);
    std::vector<std::string> environment;
    if (under_scheduler) environment.emplace_back("SLURM_JOB_ID=7");
    const Child child(output, kPace, {}, environment);
    wait_until_under_way();
    child.send(SIGTERM);
    EXPECT_EQ(child.wait(), under_scheduler ? 85 : 143);
  }
}

}  // namespace
}  // namespace montecarta::engine
