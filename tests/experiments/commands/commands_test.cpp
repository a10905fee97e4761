// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/commands.hpp"

#include "engine/errors.hpp"
#include "engine/text/visible_text.hpp"
#include "experiments/commands/arguments.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/experiments/commands/program.hpp"

namespace montecarta::experiments {
namespace {

class Commands : public BlinkProgram {
 protected:
  /// A call that may write no file beyond a few kilobytes.
  Called call_limited(const std::vector<std::string>& words) const {
    return call(words, "ulimit -f 8 && ");
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
  expect_wrong({"run", "absent.ini", "-o", "out.h5"}, "absent.ini: cannot be opened");
  expect_wrong({"list", "filtres"}, "did you mean filters?");
  expect_wrong({"info", "absent.h5"}, "absent.h5");
  expect_wrong({"bounds", "--runs", "30"}, "--dim D");
  expect_wrong({"report", "absent.h5"}, "report: -o DIR is missing");
  expect_wrong({"plan", "--dim", "3"}, "--ratio R");
  expect_wrong({"plan", "--dim", "3", "--ratio", "1"}, "neither 1 nor 0");
  const std::vector<std::pair<std::vector<std::string>, std::string>> options = {
      {{"--thrads", "2"}, "did you mean --threads?"},
      {{"stray"}, "stray: stray argument"},
      {{"--threads"}, "threads"},
      {{"--threads", "0"}, "threads"},
      {{"--backend", "cuda"}, "one of tbb, openmp, serial"},
      {{"--set", "study.runs=0"}, "--set study.runs: runs = 0"},
      {{"--runs", "2:9"}, "--runs 2:9"},
      {{"--shard", "3/3"}, "--shard 3/3"},
      {{"--runs", "0:1", "--shard", "0/3"}, "remove one of them"},
      {{"--time-budget", "soon"}, "--time-budget soon"},
      {{"--time-budget", "0"}, "--time-budget 0"},
      {{"--set", "study.seed=-1"}, "from 0 to 18446744073709551615 is"},
      {{"--set", "scenario.world=no.csv"}, "no.csv: no such world file"}};
  for (const auto& [more, words] : options) {
    std::vector<std::string> arguments = {"run", "blink.ini", "-o", "out.h5"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_wrong(arguments, words);
  }
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
  EXPECT_THAT(ran.out, HasSubstr("Page: blink_report/index.html"));
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
  EXPECT_THAT(info.out, ContainsRegex("/cells/fastslam2_m10\n    pose_mean +[0-9]"));
  for (const char* dataset : {"/truth", "/scenario", "/timing"})
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
  for (const char* words : {"fastslam2_m10", "SHA-256", "steps", "memory", "landmarks"})
    EXPECT_THAT(called.out, HasSubstr(words));
  EXPECT_THAT(called.out,
              ContainsRegex("^blink\n\n  time .*\n  file .*\n  filters +EKF-SLAM, FastSLAM II\n"
                            "  runs +3 for each of 2 cells\n"))
      << "what a person wants to know first";
  EXPECT_THAT(call({"check", "blink.ini", "--runs", "1:3"}).out, ContainsRegex("runs +2 of 3 "));
  EXPECT_FALSE(exists("out.h5"));
  EXPECT_THAT(call({"check", "blink.ini", "--text"}).out, testing::StartsWith("[study]\n"))
      << "the text alone, to be put into a file";
}

TEST_F(Commands, BoundsAreExactAndPlanSaysHowManyRuns) {
  EXPECT_THAT(call({"bounds", "--runs", "30", "--dim", "3"}).out, testing::StartsWith("[2.188"));
  expect_wrong({"bounds", "--runs", "30"}, "--dim D is missing");
  const std::string out = call({"plan", "--dim", "3", "--ratio", "1.2", "--scans", "100"}).out;
  EXPECT_THAT(out, testing::ContainsRegex("constant +339 +3688\n"));
  EXPECT_THAT(out, testing::ContainsRegex("100 independent scans +7 +124\n"));
  EXPECT_THAT(out, HasSubstr("Neighbouring scans are correlated"));
  expect_wrong({"plan", "--dim", "3", "--ratio", "1.2", "--within", "1"}, "--within");
}

TEST_F(Commands, ListsSayWhatThereIsAndAllAboutOne) {
  EXPECT_THAT(call({"list", "filters"}).out, HasSubstr("fastslam2"));
  EXPECT_THAT(call({"list", "worlds"}).out, HasSubstr("web_loop"));
  EXPECT_THAT(call({"list", "studies"}).out, HasSubstr("first_study"));
  EXPECT_THAT(call({"list", "metrics"}).out, HasSubstr("position_rmse"));
  EXPECT_THAT(call({"list", "columns"}).out, HasSubstr("ancestry"));
  EXPECT_THAT(call({"list", "settings"}).out, HasSubstr("field_of_view_deg"));
  const auto lists = [&](const char* what, const char* name, std::vector<std::string> words) {
    const Called called = call({"list", what, name});
    EXPECT_EQ(called.code, 0) << called.err;
    for (const std::string& word : words) EXPECT_THAT(called.out, HasSubstr(word));
  };
  lists("settings", "scenario.noise", {"one of measured-control, matched", "EQUATIONS 1"});
  lists("settings", "wheelbase", {"scenario.wheelbase: ", "belief.wheelbase: ", "m\n"});
  lists(
      "settings", "belief.sigma_range",
      {"must be given if scenario.kind = log", "that of [scenario] if scenario.kind = simulated"});
  lists("filters", "ukf_slam",
        {"motion ", "default quadrature, with noise = measured-control unbiased", "position",
         "motion_noise"});
  lists("studies", "first_study", {"first_study.ini"});
  lists("columns", "joint_covariance", {"run, joint, state, state_column"});
  expect_wrong({"list", "settings", "scenario.nose"}, "did you mean scenario.noise?");
  expect_wrong({"list", "settings", "wheelbse"}, "did you mean wheelbase?");
  expect_wrong({"list", "settings", "something.else"}, "choose one of them");
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

TEST_F(Commands, MoreRunsOfAStudyMergeIfTheyAreParts) {
  ASSERT_EQ(call({"run", "blink.ini", "-o", "a.h5", "--quiet"}).code, 0);
  ASSERT_EQ(
      call({"run", "blink.ini", "-o", "b.h5", "--quiet", "--set", "study.runs=5", "--runs", "3:5"})
          .code,
      0);
  EXPECT_THAT(call({"merge", "out.h5", "a.h5", "b.h5"}).err,
              HasSubstr("belongs to a study of another number of runs (5, not 3): compute the "
                        "parts of one study, all with --set study.runs=5"));
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
  const std::vector<std::string> analyze = {"analyze", "out.h5", "-o", "metrics.h5", "--force"};
  const Called full = call(analyze, "trap '' XFSZ && ulimit -f 8 && ");
  EXPECT_EQ(full.code, 1);
  EXPECT_THAT(full.err, HasSubstr("metrics.h5"));
  EXPECT_EQ(text_of("metrics.h5"), older);
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    EXPECT_NE(entry.path().extension(), ".new") << "a draft is left";
  EXPECT_EQ(call(analyze).code, 0);
  EXPECT_THAT(text_of("metrics.h5"), testing::Not(testing::HasSubstr("mine")));
}

TEST_F(Commands, TablesAndReportsAreNotOverwrittenUnaskedNorBegunWithoutGnuplot) {
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
  const Called called = call({"report", "out.h5", "-o", "other"}, "PATH=/nowhere ");
  EXPECT_EQ(called.code, 2);
  EXPECT_THAT(called.err, HasSubstr("gnuplot: not found"));
  EXPECT_FALSE(exists("other"));
}

TEST_F(Commands, AnalyzeOfManyFilesNamesEachAndRefusesAStranger) {
  for (const std::string name : {"0", "1"}) {
    ASSERT_EQ(call({"run", "blink.ini", "-o", name + ".h5", "--quiet", "--shard", name + "/2",
                    "--set", "record.full_runs=2"})
                  .code,
              0);
  }
  const Called both = call({"analyze", "0.h5", "1.h5"});
  EXPECT_EQ(both.code, 0) << both.err;
  EXPECT_THAT(both.out, testing::StartsWith("0.h5\n"));
  EXPECT_THAT(both.out, HasSubstr("\n\n1.h5\n"));
  ASSERT_EQ(call({"run", "blink.ini", "-o", "c.h5", "--quiet", "--set", "study.seed=9"}).code, 0);
  expect_refused({"analyze", "0.h5", "c.h5"}, "c.h5: holds another study");
}

TEST_F(Commands, FullStandardOutputIsAFailure) {
  EXPECT_EQ(call({"list", "settings"}, "exec > /dev/full; ").code, 1);
}

// The scripts of cluster/ call run --attempt and status --each.

class AttemptCommand : public BlinkProgram {
 protected:
  Called attempt(const std::vector<std::string>& more = {}) const {
    return call_with({"run", "blink.ini", "-o", "out.h5", "--attempt", "--quiet"}, more);
  }
};

TEST_F(AttemptCommand, StopsAtACheckpointAndTheSameCommandGoesOn) {
  const std::vector<std::string> many{"--set", "study.runs=3000", "--threads", "1"};
  std::vector<std::string> stopped = many;
  stopped.insert(stopped.end(), {"--time-budget", "0.01"});
  ASSERT_EQ(attempt(stopped).code, 85);
  EXPECT_TRUE(exists("out.h5.part"));
  EXPECT_THAT(call({"status", "--each", "out.h5.part"}).out,
              StartsWith("out.h5.part\tunfinished\t"));
  EXPECT_EQ(attempt(many).code, 0);
  EXPECT_FALSE(exists("out.h5.part"));
  EXPECT_EQ(attempt(many).code, 0) << "complete already";
}

TEST_F(AttemptCommand, ForceContradictsIt) {
  const Called called = attempt({"--force"});
  EXPECT_EQ(called.code, 2);
  EXPECT_THAT(called.err, HasSubstr("--force and --attempt"));
}

TEST_F(AttemptCommand, EachFileHasALineWhateverItIs) {
  ASSERT_EQ(attempt().code, 0);
  write("torn.h5", "torn");
  const Called called = call({"status", "--each", "--whole", "out.h5", "torn.h5", "absent.h5"});
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out,
              AllOf(ContainsRegex("^out.h5\tcomplete\t[0-9a-f]+\t6\t0\t0\t[0-9]+\\.[0-9]+\t\n"),
                    HasSubstr("\ntorn.h5\tdamaged\t\t0\t0\t0\t0\ttorn.h5: "),
                    HasSubstr("\nabsent.h5\tdamaged\t")));
  std::string bytes = text_of("out.h5");
  for (std::size_t at = bytes.size() / 2; at < bytes.size(); at += 512) bytes[at] ^= 1;
  write("out.h5", bytes);
  EXPECT_THAT(call({"status", "--each", "--whole", "out.h5"}).out, StartsWith("out.h5\tdamaged\t"));
}

const CommandSpec kSpec = read_commands(R"(About this file.

## options
of several commands
--hot  quickly

## bake DOUGH [TIN...] -o OUT
bakes
-o, --output OUT  where to
--set K=V ...  repeated
--hot
--grain rye|oat  which
--from NAME...  a list

Bakes a
loaf.
  an item
    of two lines
)")
                              .front();

TEST(Commands_md, SaysHowACommandIsCalled) {
  EXPECT_EQ(kSpec.name, "bake");
  EXPECT_EQ(kSpec.details, "Bakes a loaf.\n  an item of two lines");
  EXPECT_THAT(help_text(kSpec), AllOf(StartsWith("usage: montecarta bake DOUGH [TIN...] -o OUT"),
                                      HasSubstr("--hot            quickly\n"),
                                      HasSubstr("  -o, --output OUT     where to\n")));
}

std::string complaint_about(const std::vector<std::string>& words) {
  return engine::complaint_of([&] { Arguments(kSpec, words); });
}

TEST(Arguments, AreOptionsAndOperandsInAnyOrder) {
  const Arguments arguments(kSpec, {"--set", "a=1", "rye", "-o", "bread", "--hot", "--set=b=2",
                                    "tin", "--from", "x", "y"});
  EXPECT_THAT(arguments.operands(), ElementsAre("rye", "tin"));
  EXPECT_EQ(arguments.text("output"), "bread");
  EXPECT_TRUE(arguments.has("hot"));
  EXPECT_THAT(arguments.texts("set"), ElementsAre("a=1", "b=2"));
  EXPECT_THAT(arguments.texts("from"), ElementsAre("x", "y"));
}

TEST(Arguments, AreRefusedWhereTheyAreNotWhatTheCommandTakes) {
  EXPECT_THAT(complaint_about({}), HasSubstr("DOUGH is missing"));
  EXPECT_THAT(complaint_about({"rye", "--outptu", "x"}), HasSubstr("did you mean --output?"));
  EXPECT_THAT(complaint_about({"rye", "--out", "x"}), HasSubstr("--out: unknown option"))
      << "no guessing";
  EXPECT_THAT(complaint_about({"rye", "--hot", "--hot"}), HasSubstr("--hot: given 2 times"));
  EXPECT_THAT(complaint_about({"rye", "-o", "a", "-o", "b"}), HasSubstr("--output: given 2 times"));
  EXPECT_THAT(complaint_about({"rye", "-o", "a", "--from"}), testing::StartsWith("bake: "));
  EXPECT_THAT(complaint_about({"rye", "-o"}), testing::StartsWith("bake: "));
  EXPECT_THAT(complaint_about({"rye", "-o", "a", "--grain", "ryo"}),
              HasSubstr("(one of rye, oat): did you mean rye?"));
  EXPECT_THAT(complaint_about({"rye"}), HasSubstr("bake: -o OUT is missing (where to)"));
}

TEST(Arguments, ReadNumbersWithinLimits) {
  const Arguments arguments(kSpec, {"rye", "-o", "7", "--set", "2.5"});
  EXPECT_EQ(arguments.count("output", 1, 9), 7U);
  EXPECT_EQ(arguments.number("set", 0.0, 9.0), 2.5);
  EXPECT_EQ(arguments.number("from", 0.0, 9.0), std::nullopt);
  EXPECT_THROW(arguments.count("output", 8, 9), StudyError);
  EXPECT_THROW(arguments.count("set", 0, 9), StudyError);
}

TEST(ShellQuoted, ReadsBackAsOneWord) {
  EXPECT_EQ(shell_quoted("a/b-c.h5"), "a/b-c.h5");
  EXPECT_EQ(shell_quoted("a b"), "'a b'");
  EXPECT_EQ(shell_quoted("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_quoted(""), "''");
}

class GrowingMap : public BlinkProgram {
 protected:
  GrowingMap() : BlinkProgram(kBlink + "[association]\nkind = nearest\nmost_landmarks = 1\n") {}
};

TEST_F(GrowingMap, FailsItsRunAndNotTheStudy) {
  const Called run = call({"run", "blink.ini", "-o", "out.h5"});
  EXPECT_EQ(run.code, 3) << run.err;
  EXPECT_THAT(call({"analyze", "out.h5"}).out, testing::HasSubstr("grew beyond 1 landmarks"));
}

}  // namespace
}  // namespace montecarta::experiments
