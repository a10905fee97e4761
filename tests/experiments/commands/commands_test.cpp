// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/commands.hpp"

#include "tests/experiments/commands/program.hpp"

#include <gmock/gmock.h>

namespace montecarta::experiments {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class Commands : public Program {
 protected:
  Commands() {
    write("blink.ini", kBlink);
    write("blink.csv", kBlinkWorld);
  }
  /// A call that may write no file beyond a few kilobytes.
  Called call_limited(const std::vector<std::string>& words) const {
    return call(words, "ulimit -f 8 && ");
  }
  /// The call must end as wrong input, saying `words` and nothing else.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& words) const {
    const Called called = call(arguments);
    EXPECT_EQ(called.code, 2) << called.err;
    EXPECT_THAT(called.err, HasSubstr(words));
    EXPECT_THAT(called.out, IsEmpty());
  }
  /// Likewise, and there must be no result.
  void expect_wrong(const std::vector<std::string>& arguments, const std::string& words) const {
    expect_refused(arguments, words);
    EXPECT_FALSE(exists("out.h5"));
    EXPECT_FALSE(exists("out.h5.part"));
  }
};

TEST_F(Commands, HelpAndVersionAreForStandardOutput) {
  EXPECT_EQ(call({"--help"}).code, 0);
  EXPECT_THAT(call({"--help"}).out, HasSubstr("montecarta COMMAND"));
  EXPECT_THAT(call({"--version"}).out, testing::StartsWith("montecarta "));
  EXPECT_THAT(call({"help", "run"}).out, HasSubstr("--time-budget SECONDS"));
  EXPECT_EQ(call({}).code, 2);
  for (const Command& command : all_commands()) {
    const Called called = call({command.spec.name, "--help"});
    EXPECT_EQ(called.code, 0) << command.spec.name;
    EXPECT_THAT(called.out, HasSubstr(command.spec.summary));
  }
}

TEST_F(Commands, AShippedStudyIsKnownByItsName) {
  const Called called = call({"run", "first_study", "-o", "out.h5", "--runs", "0:1", "--quiet"});
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_TRUE(exists("out.h5"));
  write("first_study", "not a study");
  EXPECT_EQ(call({"check", "first_study"}).code, 2) << "a file of that name goes first";
}

TEST_F(Commands, WrongInputIsNamedWithItsRemedy) {
  expect_wrong({"rnu"}, "rnu: unknown command (see montecarta --help): did you mean run?");
  expect_wrong({"run", "blink.ini", "--shard", "0/3"}, "-o OUT.h5 is missing");
  expect_wrong({"run", "blink.ini", "--set", "study.name=../a"}, "'../a' names no file here");
  expect_wrong({"run", "-o", "out.h5"}, "STUDY.ini is missing");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "--thrads", "2"}, "did you mean --threads?");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "stray"}, "stray: stray argument");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "--threads"}, "threads");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "--threads", "0"}, "threads");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "--backend", "cuda"},
               "one of tbb, openmp, serial");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "--set", "study.runs=0"},
               "--set study.runs: runs = 0");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "--runs", "2:9"}, "--runs 2:9");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "--shard", "3/3"}, "--shard 3/3");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "--runs", "0:1", "--shard", "0/3"},
               "remove one of them");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "--time-budget", "soon"}, "--time-budget soon");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "--time-budget", "0"}, "--time-budget 0");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "--set", "study.seed=-1"},
               "from 0 to 18446744073709551615 is");
  expect_wrong({"run", "absent.ini", "-o", "out.h5"}, "absent.ini: cannot be opened");
  expect_wrong({"run", "blink.ini", "-o", "out.h5", "--set", "scenario.world=no.csv"},
               "no.csv: no such world file");
  expect_wrong({"list", "filtres"}, "did you mean filters?");
  expect_wrong({"info", "absent.h5"}, "absent.h5");
  expect_wrong({"bounds", "--runs", "30"}, "--dim D");
  expect_wrong({"bounds", "--match", "2.19", "many"}, "--match many: no end of an interval");
  expect_wrong({"report", "absent.h5"}, "figures need a place");
  expect_wrong({"plan", "--dim", "3"}, "--ratio R");
  expect_wrong({"plan", "--dim", "3", "--ratio", "1"}, "neither 1 nor 0");
}

TEST_F(Commands, RunStoresAndTellsWhereAndOverwritesNothing) {
  const Called ran = call({"run", "blink.ini", "-o", "out.h5", "--threads", "1"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("stored in out.h5"));
  EXPECT_THAT(ran.out, HasSubstr("ekf_slam"));
  const std::string before = text_of("out.h5");
  EXPECT_EQ(call({"run", "blink.ini", "-o", "out.h5"}).code, 2);
  EXPECT_EQ(text_of("out.h5"), before);
  EXPECT_EQ(call({"run", "blink.ini", "-o", "out.h5", "--set", "study.seed=7", "--resume"}).code, 2)
      << "another study's";
  EXPECT_EQ(text_of("out.h5"), before);
  const Called quiet = call({"run", "blink.ini", "-o", "out.h5", "--force", "--quiet"});
  EXPECT_EQ(quiet.code, 0);
  EXPECT_THAT(quiet.err + quiet.out, IsEmpty());
}

TEST_F(Commands, RunWithoutANameForResultsTakesTheStudysAndEndsWithAReport) {
  const Called ran = call({"run", "blink.ini"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_TRUE(exists("blink.h5"));
  EXPECT_THAT(ran.out, HasSubstr("ekf_slam"));
  if (ran.err.find("gnuplot") != std::string::npos) GTEST_SKIP() << "no gnuplot: no report";
  EXPECT_THAT(ran.out, HasSubstr("Report: blink_report/index.html"));
  EXPECT_TRUE(exists("blink_report/index.html"));
  std::filesystem::remove(folder_ / "blink.h5");
  expect_refused({"run", "blink.ini"}, "blink_report/index.html: is there already");
  EXPECT_FALSE(exists("blink.h5")) << "refused before a run is computed";
  EXPECT_EQ(call({"run", "blink.ini", "--force"}).code, 0);
}

TEST_F(Commands, RunWithoutGnuplotKeepsItsResults) {
  const Called ran = call({"run", "blink.ini"}, "PATH=/nowhere ");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("no report: gnuplot"));
  EXPECT_TRUE(exists("blink.h5"));
}

TEST_F(Commands, TimeBudgetEndsAtACheckpointAndTheCommandPrintedGoesOn) {
  const Called stopped = call({"run", "blink.ini", "-o", "out.h5", "--set", "study.runs=3000",
                               "--time-budget", "0.001", "--threads", "1"});
  EXPECT_EQ(stopped.code, 85) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("--resume"));
  EXPECT_TRUE(exists("out.h5.part"));
  const Called status = call({"status", "out.h5"});
  EXPECT_THAT(status.out, HasSubstr("missing"));
  EXPECT_EQ(status.err, "montecarta: out.h5 is unfinished; reading out.h5.part\n");
}

TEST_F(Commands, ALimitOnFileSizesIsNamedWithItsRemedy) {
  const Called begun = call_limited({"run", "blink.ini", "-o", "new.h5"});
  EXPECT_EQ(begun.code, 1);
  EXPECT_THAT(begun.err, HasSubstr("ulimit -f"));
  call({"run", "blink.ini", "-o", "out.h5", "--set", "study.runs=3000", "--time-budget", "0.001"});
  ASSERT_TRUE(exists("out.h5.part"));
  const Called resumed =
      call_limited({"run", "blink.ini", "-o", "out.h5", "--set", "study.runs=3000", "--resume"});
  EXPECT_EQ(resumed.code, 1);
  EXPECT_THAT(resumed.err, HasSubstr("(ulimit -f), then continue with --resume"));
}

TEST_F(Commands, InfoAndStatusReadWhatRunWrote) {
  ASSERT_EQ(call({"run", "blink.ini", "-o", "out.h5", "--quiet", "--runs", "1:3"}).code, 0);
  const Called info = call({"info", "out.h5"});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("2 of 3"));
  EXPECT_THAT(info.out, HasSubstr("2 are done in every cell"));
  EXPECT_THAT(info.out, testing::ContainsRegex("seal +holds"));
  for (const char* dataset : {"/cells/fastslam2_m10/pose_mean", "/truth", "/scenario", "/timing"})
    EXPECT_THAT(info.out, HasSubstr(dataset));
  const Called status = call({"status", "out.h5"});
  EXPECT_THAT(status.out, testing::ContainsRegex("ekf_slam +2 +0 +1 +3"));
  const Called text = call({"info", "out.h5", "--text"});
  write("again.ini", text.out);
  EXPECT_EQ(call({"run", "again.ini", "-o", "out.h5", "--resume", "--quiet", "--runs", "1:3"}).code,
            0)
      << "the resolved text is the study";
}

TEST_F(Commands, CheckRunsNothing) {
  const Called called = call({"check", "blink.ini"});
  EXPECT_EQ(called.code, 0) << called.err;
  for (const char* words : {"fastslam2_m10", "SHA-256", "3 of 3", "steps", "memory", "disk"})
    EXPECT_THAT(called.out, HasSubstr(words));
  EXPECT_FALSE(exists("out.h5"));
  EXPECT_THAT(call({"check", "blink.ini", "--text"}).out, testing::StartsWith("[study]\n"))
      << "the text alone, to be put into a file";
}

TEST_F(Commands, BoundsAreExact) {
  EXPECT_THAT(call({"bounds", "--runs", "30", "--dim", "3"}).out, testing::StartsWith("[2.188"));
  EXPECT_THAT(call({"bounds", "--match", "1.3", "2.79"}).out, testing::ContainsRegex("20 +2 +0.9"));
  EXPECT_EQ(call({"bounds", "--match", "2.79"}).code, 2);
  expect_wrong({"bounds", "--runs", "30", "--dim", "3", "--match", "1.3", "2.79"},
               "--match and --runs");
}

TEST_F(Commands, PlanSaysHowManyRuns) {
  const std::string out = call({"plan", "--dim", "3", "--ratio", "1.2", "--scans", "100"}).out;
  EXPECT_THAT(out, testing::ContainsRegex("constant +215 +966 +1152\n"));
  EXPECT_THAT(out, testing::ContainsRegex("100 independent scans +5 +12 +16\n"));
  EXPECT_THAT(out, HasSubstr("Neighbouring scans are correlated"));
  expect_wrong({"plan", "--dim", "3", "--ratio", "1.2", "--within", "1"}, "--within");
}

TEST_F(Commands, ListsSayWhatThereIs) {
  EXPECT_THAT(call({"list", "filters"}).out, HasSubstr("fastslam2"));
  EXPECT_THAT(call({"list", "scenarios"}).out, HasSubstr("web_loop"));
  EXPECT_THAT(call({"list", "studies"}).out, HasSubstr("first_study.ini"));
  EXPECT_THAT(call({"list", "columns"}).out, HasSubstr("ancestry"));
  EXPECT_THAT(call({"list", "settings"}).out, HasSubstr("scenario.field_of_view_deg"));
}

TEST_F(Commands, ShardsMergeIntoTheWhole) {
  ASSERT_EQ(call({"run", "blink.ini", "-o", "a.h5", "--quiet", "--shard", "0/2"}).code, 0);
  ASSERT_EQ(call({"run", "blink.ini", "-o", "b.h5", "--quiet", "--shard", "1/2"}).code, 0);
  const Called gap = call({"merge", "out.h5", "a.h5"});
  EXPECT_EQ(gap.code, 2) << gap.err;
  EXPECT_FALSE(exists("out.h5"));
  EXPECT_EQ(call({"merge", "out.h5", "a.h5", "b.h5"}).code, 0);
  EXPECT_THAT(call({"status", "out.h5"}).out, testing::ContainsRegex("ekf_slam +3 +0 +0 +3"));
}

TEST_F(Commands, NothingThatIsReadIsEverReplaced) {
  EXPECT_EQ(call({"run", "blink.ini", "-o", "blink.ini", "--force"}).code, 2);
  EXPECT_EQ(call({"run", "blink.ini", "-o", "blink.csv", "--force"}).code, 2);
  EXPECT_EQ(text_of("blink.ini"), kBlink);
  EXPECT_EQ(text_of("blink.csv"), kBlinkWorld);
  ASSERT_EQ(call({"run", "blink.ini", "-o", "out.h5", "--quiet"}).code, 0);
  std::filesystem::create_symlink("out.h5", folder_ / "soft.h5");
  std::filesystem::create_hard_link(folder_ / "out.h5", folder_ / "hard.h5");
  std::filesystem::create_symlink("out.h5", folder_ / "late.h5.part");
  const std::string before = text_of("out.h5");
  for (const char* output : {"out.h5", "./out.h5", "soft.h5", "hard.h5", "late.h5.part"}) {
    const Called called = call({"analyze", "out.h5", "-o", output, "--force"});
    EXPECT_EQ(called.code, 2) << output;
    EXPECT_THAT(called.err, HasSubstr("is the same file as out.h5")) << output;
  }
  EXPECT_EQ(call({"analyze", "late.h5", "-o", "late.h5.part", "--force"}).code, 2);
  EXPECT_EQ(text_of("out.h5"), before);
}

TEST_F(Commands, AnalyzeOnAFullDiskLeavesWhatWasThere) {
  ASSERT_EQ(call({"run", "blink.ini", "-o", "out.h5", "--quiet"}).code, 0);
  const std::string older = "\x89HDF\r\n\x1a\nmine";
  write("metrics.h5", older);
  const std::string line = "cd " + shell_quoted(folder_.string()) +
                           " && trap '' XFSZ && ulimit -f 8 && " MONTECARTA_EXECUTABLE
                           " analyze out.h5 -o metrics.h5 --force > stdout 2> stderr";
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 1);
  EXPECT_THAT(text_of("stderr"), HasSubstr("metrics.h5"));
  EXPECT_THAT(text_of("stderr"), HasSubstr("cannot be written"));
  EXPECT_EQ(text_of("metrics.h5"), older);
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    EXPECT_NE(entry.path().extension(), ".new") << "a draft is left";
  EXPECT_EQ(call({"analyze", "out.h5", "-o", "metrics.h5", "--force"}).code, 0);
  EXPECT_THAT(text_of("metrics.h5"), testing::Not(testing::HasSubstr("mine")));
}

TEST_F(Commands, TablesAndReportsAreNotOverwrittenUnasked) {
  ASSERT_EQ(call({"run", "blink.ini", "-o", "out.h5", "--quiet"}).code, 0);
  std::filesystem::create_directories(folder_ / "csv");
  write("csv/series_ekf_slam.csv", "mine");
  expect_refused({"analyze", "out.h5", "--csv", "csv"}, "series_ekf_slam.csv: is there already");
  EXPECT_EQ(text_of("csv/series_ekf_slam.csv"), "mine");
  EXPECT_FALSE(exists("csv/cells.csv"));
  EXPECT_EQ(call({"analyze", "out.h5", "--csv", "csv", "--force"}).code, 0);
  EXPECT_THAT(text_of("csv/series_ekf_slam.csv"), testing::StartsWith("time"));
  std::filesystem::create_directories(folder_ / "report/tables");
  expect_refused({"report", "out.h5", "-o", "report"}, "report/tables: is there already");
}

TEST_F(Commands, ReportWithoutGnuplotWritesNothing) {
  ASSERT_EQ(call({"run", "blink.ini", "-o", "out.h5", "--quiet"}).code, 0);
  const std::string line = "cd " + shell_quoted(folder_.string()) +
                           " && PATH=/nowhere " MONTECARTA_EXECUTABLE
                           " report out.h5 -o report 2> stderr";
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 2);
  EXPECT_THAT(text_of("stderr"), HasSubstr("gnuplot: not found"));
  EXPECT_FALSE(exists("report"));
}

TEST_F(Commands, AnalyzeOfManyFilesNamesEachAndRefusesAStranger) {
  ASSERT_EQ(call({"run", "blink.ini", "-o", "a.h5", "--quiet", "--shard", "0/2"}).code, 0);
  ASSERT_EQ(call({"run", "blink.ini", "-o", "b.h5", "--quiet", "--shard", "1/2"}).code, 0);
  const Called both = call({"analyze", "a.h5", "b.h5"});
  EXPECT_EQ(both.code, 0) << both.err;
  EXPECT_THAT(both.out, testing::StartsWith("a.h5\n"));
  EXPECT_THAT(both.out, HasSubstr("\n\nb.h5\n"));
  ASSERT_EQ(call({"run", "blink.ini", "-o", "c.h5", "--quiet", "--set", "study.seed=9"}).code, 0);
  expect_refused({"analyze", "a.h5", "c.h5"}, "c.h5: holds another study");
}

TEST_F(Commands, FullStandardOutputIsAFailure) {
  const std::string line =
      std::string(MONTECARTA_EXECUTABLE) + " list settings > /dev/full 2> /dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 1);
}

}  // namespace
}  // namespace montecarta::experiments
