// SPDX-License-Identifier: BSD-3-Clause
// Studies that store sums over groups of runs in place of the runs.
#include "analysis/study/stored_sums.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/records/result_file.hpp"
#include "engine/records/sum_groups.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/experiments/commands/program.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <sstream>

namespace montecarta::experiments {
namespace {

constexpr std::uint64_t kSummedRuns = kRunsOfAGroup + 200;

/// The cells of a line of a table, with commas inside quotes kept.
std::vector<std::string> split_quoted(const std::string& line) {
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  for (const char c : line) {
    if (c == '"') is_quoted = !is_quoted;
    if (c == ',' && !is_quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

// Slow: thousands of runs, too many for a sanitizer (blocks_of_runs_test.cpp has few).
class SlowSummedStudy : public BlinkProgram {
 protected:
  SlowSummedStudy() : BlinkProgram(study()) {}
  /// Thousands of runs take a second.
  static std::string study() {
    return "[study]\nname = blink\nruns = " + std::to_string(kSummedRuns) +
           "\n[scenario]\nworld = blink.csv\ncontrol_rate = 10\nscan_rate = 2.5\n[cells]\n"
           "cell = ekf_slam\n"
           "cell = fastslam2 particles=10\n[record]\ncolumns = sums\n";
  }
  Called run(const std::string& out, const std::vector<std::string>& more = {}) const {
    return call_with({"run", "blink.ini", "-o", out, "--quiet"}, more);
  }
  /// {cell} All words of the sums.
  std::vector<std::vector<std::uint64_t>> words_of(const std::string& name) const {
    const ResultFile file(folder_ / name);
    std::vector<std::vector<std::uint64_t>> words;
    for (const StoredCell& cell : file.cells()) {
      auto& of_cell = words.emplace_back();
      for (const SumGroup& group : file.sum_groups(cell)) {
        const auto sums = file.sums(group);
        of_cell.insert(of_cell.end(), {group.first_run, group.runs, group.complete, group.failed});
        of_cell.insert(of_cell.end(), sums.begin(), sums.end());
      }
    }
    return words;
  }
  std::size_t rows_of_a_run(const std::string& name) const {
    return ResultFile(folder_ / name).times().size();
  }
  /// The text of a table without columns of processor time.
  std::string table(const std::string& name) const {
    std::istringstream lines(text_of(name));
    std::vector<bool> is_time;
    std::string all;
    for (std::string line; std::getline(lines, line);) {
      const std::vector<std::string> cells = split_quoted(line);
      for (std::size_t column = 0; column < cells.size(); ++column) {
        if (column == is_time.size()) is_time.push_back(cells[column].starts_with("cpu"));
        if (!is_time[column]) all.append(cells[column]).append(",");
      }
      all.append("\n");
    }
    return all;
  }
};

TEST_F(SlowSummedStudy, SaysTheSameAsOneWithAllRows) {
  ASSERT_EQ(run("sums.h5").code, 0);
  ASSERT_EQ(run("rows.h5",
                {"--set", "record.columns=pose,covariance,ancestry", "--set", "record.rate=scan"})
                .code,
            0);
  EXPECT_LT(std::filesystem::file_size(folder_ / "sums.h5"),
            std::filesystem::file_size(folder_ / "rows.h5"));
  for (const char* name : {"sums", "rows"}) {
    ASSERT_EQ(call({"analyze", std::string(name) + ".h5", "--csv", name}).code, 0);
  }
  std::size_t tables = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder_ / "rows")) {
    const std::string name = file.path().filename().string();
    EXPECT_EQ(table("sums/" + name), table("rows/" + name)) << name;
    ++tables;
  }
  EXPECT_GT(tables, 5U);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"gate", "--json", "--cell", "ekf_slam"},
        {"compare", "--baseline", "ekf_slam", "--metric", "position_rmse"}}) {
    const Called rows = call_with(words, {"rows.h5"}), sums = call_with(words, {"sums.h5"});
    EXPECT_EQ(sums.code, rows.code) << sums.err;
    ASSERT_NE(rows.out, "") << rows.err;
    EXPECT_EQ(sums.out.substr(sums.out.find('\n')), rows.out.substr(rows.out.find('\n')));
  }
}

TEST_F(SlowSummedStudy, StoresItsFirstRunsAtScansAndJudgesThoseOfOneWithAllRows) {
  const std::vector<std::string> from{"--set", "study.judge_from=2"};
  const auto verdict_in = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.end(), from.begin(), from.end());
    EXPECT_EQ(run(name, more).code, 0);
    const Called analysed = call({"analyze", name});
    return analysed.out.substr(0, analysed.out.find("CPU/run"));
  };
  const std::string sums = verdict_in("sums.h5", {});
  EXPECT_THAT(sums, testing::HasSubstr("judged from 2 s on"));
  EXPECT_EQ(sums, verdict_in("rows.h5", {"--set", "record.columns=pose,covariance,ancestry"}));
  EXPECT_GT(rows_of_a_run("rows.h5"), 3 * rows_of_a_run("sums.h5"));
}

TEST_F(SlowSummedStudy, HasTheSameBitsHoweverItIsRun) {
  ASSERT_EQ(run("one.h5", {"--threads", "1"}).code, 0);
  const auto wanted = words_of("one.h5");
  for (const char* threads : {"2", "8"}) {
    ASSERT_EQ(run("many.h5", {"--threads", threads, "--force"}).code, 0);
    EXPECT_EQ(words_of("many.h5"), wanted) << threads;
  }
  for (const std::string shard : {"0", "1"}) {
    ASSERT_EQ(run("shard" + shard + ".h5", {"--shard", shard + "/2"}).code, 0);
  }
  ASSERT_EQ(call({"merge", "merged.h5", "shard1.h5", "shard0.h5"}).code, 0);
  EXPECT_EQ(words_of("merged.h5"), wanted);
  EXPECT_EQ(call({"verify", "merged.h5", "--seed", "1"}).code, 0);
  expect_refused({"merge", "part.h5", "shard1.h5"}, "--runs 0:4096");
  expect_refused({"analyze", "shard1.h5"}, "merge it");
}

TEST_F(SlowSummedStudy, IsResumedAfterItWasStoppedOrKilled) {
  ASSERT_EQ(run("whole.h5").code, 0);
  EXPECT_EQ(run("out.h5", {"--time-budget", "0.01"}).code, 85);
  EXPECT_TRUE(exists("out.h5.groups"));
  EXPECT_EQ(call({"status", "out.h5"}).code, 0);
  EXPECT_THAT(call({"status", "--each", "out.h5"}).out, StartsWith("out.h5\tunfinished\t"));
  EXPECT_EQ(call({"info", "out.h5"}).code, 0);
  expect_refused({"run", "blink.ini", "-o", "out.h5"}, "--resume");
  const std::vector<std::string> on = {"run", "blink.ini", "-o", "out.h5", "--quiet", "--resume"};
  for (const char* seconds : {"0.1", "0.2", "0.4"}) {
    call(on, std::string("timeout -s KILL ") + seconds + " ");
  }
  EXPECT_EQ(call(on).code, 0);
  EXPECT_EQ(words_of("out.h5"), words_of("whole.h5"));
  EXPECT_FALSE(exists("out.h5.groups"));
}

TEST_F(SlowSummedStudy, IsNotTakenForAnotherThatIsThere) {
  ASSERT_EQ(run("whole.h5").code, 0);
  ASSERT_EQ(run("out.h5", {"--set", "study.seed=5"}).code, 0);
  EXPECT_EQ(run("out.h5", {"--force", "--time-budget", "0.01"}).code, 85);
  EXPECT_EQ(run("out.h5", {"--resume"}).code, 0);
  EXPECT_EQ(words_of("out.h5"), words_of("whole.h5"));
  ASSERT_EQ(run("part.h5", {"--runs", "0:4096"}).code, 0);
  expect_refused({"run", "blink.ini", "-o", "part.h5", "--resume"}, "other runs");
}

TEST_F(SlowSummedStudy, ComputesADamagedGroupAgainAndLeavesForeignFiles) {
  ASSERT_EQ(run("whole.h5").code, 0);
  ASSERT_EQ(run("group.h5", {"--runs", "0:4096"}).code, 0);
  std::filesystem::create_directory(folder_ / "out.h5.groups");
  std::string text = text_of("group.h5");
  text[text.size() / 2] ^= 1;
  write("out.h5.groups/group_0.h5", text);
  write("out.h5.groups/thesis.txt", "mine");
  EXPECT_EQ(run("out.h5", {"--resume"}).code, 0);
  EXPECT_EQ(words_of("out.h5"), words_of("whole.h5"));
  EXPECT_EQ(text_of("out.h5.groups/thesis.txt"), "mine");
}

TEST_F(SlowSummedStudy, IsRefusedWithAFlippedByte) {
  ASSERT_EQ(run("out.h5", {"--runs", "0:4096"}).code, 0);
  const ResultFile file(folder_ / "out.h5");
  const SumGroup group = file.sum_groups(file.cells().front()).front();
  const std::uint64_t bytes = 8 * (kGroupHeadWords + group.words);
  const std::string whole = text_of("out.h5");
  for (std::uint64_t k = 0; k < 40; ++k) {
    std::string text = whole;
    text[group.offset + k * (bytes - 1) / 39] ^= 1;
    write("out.h5", text);
    expect_refused({"analyze", "out.h5"}, "damaged");
  }
}

TEST_F(SlowSummedStudy, IsRefusedIfAnotherVersionWroteItsSums) {
  ASSERT_EQ(run("rows.h5", {"--runs", "0:16", "--set", "record.columns=pose,covariance", "--set",
                            "study.runs=16"})
                .code,
            0);
  const ResultFile rows(folder_ / "rows.h5");
  std::vector<NewGroup> groups = sums_to_store(rows, Parallel::serial());
  write_group(folder_ / "same.h5", folder_ / "rows.h5", groups);
  EXPECT_EQ(call({"analyze", "same.h5"}).code, 0);
  for (NewGroup& group : groups) ++group.head.layout;
  write_group(folder_ / "other.h5", folder_ / "rows.h5", groups);
  expect_refused({"analyze", "other.h5"}, "another layout");
}

TEST_F(SlowSummedStudy, LeavesNoFolderIfTheDiskIsTooSmall) {
  const Called called = run(
      "out.h5", {"--set", "scenario.control_rate=1e5", "--set", "scenario.scan_rate=1e5", "--set",
                 "record.rate=control", "--set", "record.columns=sums, map, particles"});
  EXPECT_EQ(called.code, 1);
  EXPECT_THAT(called.err, testing::HasSubstr("are needed"));
  EXPECT_FALSE(exists("out.h5.groups"));
}

/// The seal of such a file holds.
TEST_F(SlowSummedStudy, NamesTheFileWhereSumsContradictEachOther) {
  ASSERT_EQ(run("rows.h5", {"--runs", "0:16", "--set", "record.columns=pose,covariance", "--set",
                            "study.runs=16"})
                .code,
            0);
  const auto whole = sums_to_store(ResultFile(folder_ / "rows.h5"), Parallel::serial());
  std::size_t refused = 0;
  for (std::size_t k = 0; k < whole.front().sums.size(); ++k) {
    if (whole.front().sums[k] != 16) continue;
    std::vector<NewGroup> groups = whole;
    groups.front().sums[k] = ~std::uint64_t{0};
    write_group(folder_ / "sums.h5", folder_ / "rows.h5", groups);
    const ResultFile file(folder_ / "sums.h5");
    const std::string complaint = complaint_of([&] { analysis::analyze(file); });
    if (complaint == "nothing") continue;
    EXPECT_THAT(complaint, testing::HasSubstr("sums.h5")) << k;
    ++refused;
  }
  EXPECT_GT(refused, 5U);
}

TEST_F(SlowSummedStudy, RefusesWhatNeedsRows) {
  const std::vector<std::string> check = {"check", "blink.ini"};
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--runs", "0:100"},
                                               {"--shard", "0/3"},
                                               {"--set", "record.full_runs=5000"},
                                               {"--set", "study.until=position_rmse<1"}}) {
    const Called called = call_with(check, more);
    EXPECT_EQ(called.code, 2) << called.out;
    EXPECT_THAT(called.err, testing::AnyOf(testing::HasSubstr("group"), testing::HasSubstr("sums"),
                                           testing::HasSubstr("4096")));
  }
  ASSERT_EQ(run("out.h5", {"--runs", "0:4096"}).code, 0);
  expect_refused({"analyze", "out.h5", "--level", "0.9"}, "made for the level 0.95");
}

}  // namespace
}  // namespace montecarta::experiments
