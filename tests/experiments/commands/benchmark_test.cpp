// SPDX-License-Identifier: BSD-3-Clause
// benchmark, compare --archive and verify --archive.
#include "engine/records/fingerprint.hpp"
#include "experiments/text/words.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/experiments/commands/program.hpp"

namespace montecarta::experiments {
namespace {

const std::vector<std::string> kTwoFilters = {"--cell", "ekf_slam label=a", "--cell",
                                              "dead_reckoning label=b"};

class Benchmark : public Program {
 protected:
  /// Runs two filters 70 times in two worlds, of which one does not suit the second filter.
  Called run(const std::string& folder, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"benchmark", folder, "--runs", "70", "--quiet"};
    words.insert(words.end(), kTwoFilters.begin(), kTwoFilters.end());
    if (std::ranges::find(more, "--world") == more.end())
      words.insert(words.end(), {"--world", "corridor_easy,known_map"});
    return call_with(std::move(words), more);
  }
  /// Runs a program by a command.
  Called run_command(const std::string& command) const {
    return call({"benchmark", "out", "--runs", "70", "--world", "corridor_easy", "--allow-external",
                 "--cell", "external label=mine command=" + in_quotes(command)});
  }
  /// Runs tests/doubles/scripted_program.cpp in a mode, by a command that names mine.txt.
  Called run_program(const std::string& mode) const {
    return run_command(MONTECARTA_SCRIPTED_PROGRAM " " + mode + " mine.txt");
  }
  /// The line of a text that begins with `begin`, from its first number on.
  static std::string numbers_of(const std::string& text, const std::string& begin) {
    const std::size_t line = ("\n" + text).find("\n" + begin);
    const std::string found = text.substr(line, text.find('\n', line) - line).substr(begin.size());
    return found.substr(found.find_first_of("0123456789"));
  }
  /// An entry without what is no part of the result.
  std::string result_of(const std::string& entry) const {
    std::string text = text_of(entry);
    const std::size_t from = text.find(" \"made_by\""), to = text.find(" \"verdict\"");
    return text.erase(from, to - from);
  }
  /// Replaces a text in a file once.
  void alter(const std::string& file, const std::string& from, const std::string& to) const {
    std::string text = text_of(file);
    ASSERT_NE(text.find(from), std::string::npos) << from;
    write(file, text.replace(text.find(from), from.size(), to));
  }
};

TEST_F(Benchmark, RunsEveryFilterWhereTheWorldSuitsItAndDraws) {
  const Called called = run("out");
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_TRUE(exists("out/corridor_easy/a.json") && exists("out/corridor_easy/b.json"));
  EXPECT_TRUE(exists("out/known_map/a.json"));
  EXPECT_FALSE(exists("out/known_map/b.json"));
  EXPECT_FALSE(exists("out/corridor_easy/a.json.claim.1"));
  EXPECT_THAT(text_of("out/matrix.csv"), HasSubstr("corridor_easy,a,"));
  EXPECT_THAT(text_of("out/matrix.svg"), HasSubstr("</svg>"));
  EXPECT_THAT(text_of("out/index.html"), HasSubstr("<h2>known_map</h2>"));
  EXPECT_THAT(called.out, HasSubstr("the world does not suit the filter"));
}

TEST_F(Benchmark, NamesAResultThatNoProcessMayBeginAgain) {
  std::filesystem::create_directories(folder_ / "out/corridor_easy");
  for (int i = 1; i <= 5; ++i) {
    write("out/corridor_easy/a.json.claim." + std::to_string(i),
          "failed on ghost 17: its reason\n");
  }
  const Called called = run("out", {"--world", "corridor_easy", "--patience", "0.2"});
  EXPECT_EQ(called.code, 1);
  EXPECT_THAT(called.err, HasSubstr("a.json.claim.*: failed on ghost 17: its reason"));
  EXPECT_TRUE(exists("out/corridor_easy/b.json")) << "others are made";
}

TEST_F(Benchmark, HasTheSameResultsOnAnyNumberOfThreadsAndAfterAKill) {
  ASSERT_EQ(run("one", {"--threads", "1"}).code, 0);
  std::vector<std::string> words = {"benchmark", "two",     "--runs",       "70",
                                    "--quiet",   "--world", "corridor_easy"};
  words.insert(words.end(), kTwoFilters.begin(), kTwoFilters.end());
  is_killed_at("two/corridor_easy/*.groups", words);
  ASSERT_EQ(run("two", {"--threads", "3", "--patience", "0.2"}).code, 0);
  for (const char* entry : {"/corridor_easy/a.json", "/corridor_easy/b.json", "/known_map/a.json"})
    EXPECT_EQ(result_of(std::string("one") + entry), result_of(std::string("two") + entry));
}

TEST_F(Benchmark, KeepsResultsOfOtherRunsAsTheyAre) {
  ASSERT_EQ(run("out").code, 0);
  const std::string before = text_of("out/corridor_easy/a.json");
  expect_refused({"benchmark", "out", "--runs", "80", "--cell", "ekf_slam label=a", "--world",
                  "corridor_easy"},
                 "is of 70 runs, and 80 are asked for");
  expect_refused({"benchmark", "out", "--runs", "70", "--cell", "ekf_slam label=a iterations=2",
                  "--world", "corridor_easy"},
                 "is of another filter, which had this label");
  EXPECT_EQ(text_of("out/corridor_easy/a.json"), before);
}

TEST_F(Benchmark, RefusesFiltersThatHaveNoResultOfTheirOwn) {
  expect_refused({"benchmark", "out", "--cell", "fastslam2 particles=10,20"},
                 "describes 2 filters");
  expect_refused({"benchmark", "out", "--cell", "ekf_slam label=a", "--cell", "ukf_slam label=a"},
                 "a second filter with the label a");
  expect_refused({"benchmark", "out", "--cell", "smoother label=a", "--world", "known_map"},
                 "smoother with belief.map = known");
  expect_refused({"benchmark", "out", "--world", "moon"}, "no world of the benchmark");
  expect_refused({"benchmark", "out", "--draw"}, "no such folder");
}

TEST_F(Benchmark, OfAProgramNeedsLeave) {
  expect_refused({"benchmark", "out", "--cell", "external label=mine command=\"true\"", "--world",
                  "corridor_easy"},
                 "add --allow-external");
}

TEST_F(Benchmark, KeepsAResultUntilAFileOfItsProgramChanges) {
  write("mine.txt", "first");
  ASSERT_EQ(run_program("good -1").code, 0);
  const std::string first = text_of("out/corridor_easy/mine.json");
  EXPECT_THAT(first, HasSubstr("\"mine.txt\": \"" + sha256("first")));
  EXPECT_THAT(run_program("good -1").err,
              ContainsRegex("mine in corridor_easy: result of .* kept"));
  EXPECT_EQ(text_of("out/corridor_easy/mine.json"), first);

  write("mine.txt", "second");
  const Called changed = run_program("good -1");
  EXPECT_EQ(changed.code, 0);
  EXPECT_THAT(changed.err, HasSubstr("mine.txt has changed since the result of mine"));
  EXPECT_THAT(text_of("out/corridor_easy/mine.json"), HasSubstr(sha256("second")));

  write("mine.txt", "third");  // the result without its entry is an old one as well
  std::filesystem::remove(folder_ / "out/corridor_easy/mine.json");
  EXPECT_THAT(run_program("good -1").err, HasSubstr("mine.txt has changed since work on mine"));
  EXPECT_THAT(text_of("out/corridor_easy/mine.json"), HasSubstr(sha256("third")));

  std::filesystem::remove(folder_ / "mine.txt");
  const Called gone = run_program("good -1");
  EXPECT_EQ(gone.code, 2);
  EXPECT_THAT(gone.err, HasSubstr("mine.txt: no such file"));
  EXPECT_TRUE(exists("out/corridor_easy/mine.h5"));
}

TEST_F(Benchmark, NoticesAChangedFileInTheCommandOfAShell) {
  const std::string command = "sh -c '" MONTECARTA_SCRIPTED_PROGRAM
                              " good -1 mine.txt mine.txt 2>>log.txt 3> other.txt' \"it's mine\"";
  write("mine.txt", "first");
  for (const char* log : {"log.txt", "other.txt"}) write(log, "");
  ASSERT_EQ(run_command(command).code, 0);
  EXPECT_THAT(text_of("out/corridor_easy/mine.json"), HasSubstr(sha256("first")));
  for (const char* log : {"log.txt", "other.txt"}) write(log, "a line\n");
  EXPECT_THAT(run_command(command).err, HasSubstr("kept"));
  write("mine.txt", "second");
  EXPECT_THAT(run_command(command).err, HasSubstr("mine.txt has changed since the result of mine"));
}

TEST_F(Benchmark, KeepsAResultIfAFileAppearsOrNoneIsKnown) {
  write("mine.txt", "");
  ASSERT_EQ(run_program("good -1 run.log").code, 0);
  write("run.log", "of the program");
  EXPECT_THAT(run_program("good -1 run.log").err, HasSubstr("kept, not computed again\n"));

  alter("out/corridor_easy/mine.json", "\"program_files\"", "\"absent\"");
  const std::string entry = text_of("out/corridor_easy/mine.json");
  EXPECT_THAT(run_program("good -1 run.log").err, HasSubstr("no file of its program is stored"));
  EXPECT_EQ(text_of("out/corridor_easy/mine.json"), entry);
}

TEST_F(Benchmark, RemovesAnOldResultOnlyUnderAClaim) {
  write("mine.txt", "first");
  ASSERT_EQ(run_program("good -1").code, 0);
  const std::string entry = text_of("out/corridor_easy/mine.json");
  write("mine.txt", "second");
  write("out/corridor_easy/mine.json.claim.1", "at work: another 1\n");
  const Called other = run_program("good -1");
  EXPECT_EQ(other.code, 0);
  EXPECT_THAT(other.err, HasSubstr("mine in corridor_easy: another process has claimed it"));
  EXPECT_EQ(text_of("out/corridor_easy/mine.json"), entry);
  EXPECT_TRUE(exists("out/corridor_easy/mine.h5"));
  std::filesystem::remove(folder_ / "out/corridor_easy/mine.json.claim.1");
  EXPECT_EQ(run_program("good -1").code, 0);
  EXPECT_THAT(text_of("out/corridor_easy/mine.json"), HasSubstr(sha256("second")));
}

TEST_F(Benchmark, OfAProgramThatNeverAnswersLeavesNothing) {
  write("mine.txt", "");
  for (int attempt = 0; attempt < 5; ++attempt) run_program("exit 0");  // any number of them
  const Called called = run_program("exit 0");
  EXPECT_EQ(called.code, 1);
  EXPECT_THAT(called.err, AllOf(HasSubstr("mine in corridor_easy: "), HasSubstr("--world NAME")));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "out/corridor_easy"));
  EXPECT_EQ(run_program("good -1").code, 0) << "the label is free";
}

TEST_F(Benchmark, DoesNotTakeTheTimeBesideAProgramForItsCost) {
  write("mine.txt", "");
  ASSERT_EQ(run_program("good -1").code, 0);
  EXPECT_THAT(text_of("out/corridor_easy/mine.json"), HasSubstr("\"cpu_seconds\": null"));
}

TEST_F(Benchmark, PrintsTheWorldsThatAreAskedFor) {
  ASSERT_EQ(run("out").code, 0);
  const Called called = call({"benchmark", "out", "--draw", "--world", "known_map"});
  EXPECT_THAT(called.out, AllOf(HasSubstr("known map"), Not(HasSubstr("corridor"))));
  EXPECT_THAT(text_of("out/index.html"), HasSubstr("<h2>corridor_easy</h2>"));
}

TEST_F(Benchmark, ArchiveIsReproducedAndADifferenceIsFound) {
  ASSERT_EQ(run("out").code, 0);
  const std::vector<std::string> verify = {"verify", "--archive", "out", "--sample", "100"};
  const Called whole = call(verify);
  EXPECT_EQ(whole.code, 0) << whole.out;
  EXPECT_THAT(whole.out, StartsWith("6 of 6 blocks of 64 runs are reproduced byte for byte"));
  EXPECT_EQ(call({"verify", "--archive", "out", "--whole"}).code, 0);

  const std::string entry = text_of("out/corridor_easy/a.json");
  const auto expect_difference = [&](const std::string& words,
                                     const std::vector<std::string>& more) {
    const Called called = call_with({"verify", "--archive", "out/corridor_easy/a.json"}, more);
    EXPECT_EQ(called.code, 4) << called.out << called.err;
    EXPECT_THAT(called.out, HasSubstr(words));
    write("out/corridor_easy/a.json", entry);
  };
  const std::size_t blocks = entry.find("\"blocks\": \"") + 11;
  alter("out/corridor_easy/a.json", entry.substr(blocks, 8), "12345678");
  expect_difference("corridor_easy/a, runs 0 to 63: estimates differ", {});
  const std::size_t heading = entry.find("\"heading_rmse\": \"") + 17;
  alter("out/corridor_easy/a.json", entry.substr(heading, 8),
        entry.substr(heading + 4, 4) + entry.substr(heading + 4, 4));
  expect_difference("corridor_easy/a, runs 0 to 63: heading_rmse differs", {});
  alter("out/corridor_easy/a.json", "\"nees_ratio\": ", "\"nees_ratio\": 7");
  expect_difference("corridor_easy/a: its verdict or runs differ", {"--whole"});
  alter("out/corridor_easy/a.json", "label=a", "label=a iterations=3");
  expect_difference("corridor_easy/a: is not of the study", {});
}

TEST_F(Benchmark, ADamagedEntryIsNamedWithARemedy) {
  ASSERT_EQ(run("out", {"--world", "corridor_easy"}).code, 0);
  const std::string entry = text_of("out/corridor_easy/a.json");
  const auto expect_error = [&](const std::string& text, const std::string& words) {
    write("out/corridor_easy/a.json", text);
    for (const std::vector<std::string>& words_of_call :
         {std::vector<std::string>{"benchmark", "out", "--draw"},
          {"verify", "--archive", "out"},
          {"compare", "out/corridor_easy/b.h5", "--archive", "--entries", "out"}}) {
      const Called called = call(words_of_call);
      EXPECT_EQ(called.code, 2);
      EXPECT_THAT(called.err, AllOf(HasSubstr("out/corridor_easy/a.json: "), HasSubstr(words),
                                    HasSubstr("make it again")));
    }
  };
  expect_error(entry.substr(0, entry.size() / 2), "is no entry of an archive");
  expect_error("{}", "is no entry of an archive");
  std::string shorter = entry;
  expect_error(shorter.erase(entry.find("\"nees\": \"") + 9, 4), "has not one score for each run");
  std::string other = entry;
  expect_error(other.replace(entry.find("optimistic") == std::string::npos ? 0 : 0, 0, "x"),
               "is no entry of an archive");
  std::filesystem::rename(folder_ / "out/corridor_easy/a.json",
                          folder_ / "out/corridor_easy/c.json");
  write("out/corridor_easy/c.json", entry);
  EXPECT_THAT(call({"benchmark", "out", "--draw"}).err,
              HasSubstr("move it to corridor_easy/a.json"));
}

TEST_F(Benchmark, ComparesAResultWithAnArchiveRunByRun) {
  ASSERT_EQ(run("out", {"--world", "corridor_easy"}).code, 0);
  const Called called =
      call({"compare", "out/corridor_easy/a.h5", "--archive", "--entries", "out"});
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out, HasSubstr("a (yours)"));
  // The same filter is equal in every run, in spite of the precision of the archive.
  EXPECT_THAT(called.out, ContainsRegex("NEES ratio +a +0.00 +1.00 +0.0 %"));
  EXPECT_THAT(called.out, ContainsRegex("position_rmse \\[m\\] +b "));
  expect_refused({"compare", "out/corridor_easy/a.h5", "--entries", "out"}, "without --archive");
}

TEST_F(Benchmark, ComparesFewerRunsWithTheSameOnesOfTheArchive) {
  ASSERT_EQ(run("out", {"--world", "corridor_easy"}).code, 0);
  ASSERT_EQ(call({"benchmark", "few", "--runs", "20", "--cell", "ekf_slam label=mine", "--world",
                  "corridor_easy"})
                .code,
            0);
  const Called called =
      call({"compare", "few/corridor_easy/mine.h5", "--archive", "--entries", "out"});
  // a is the same filter: ratio, interval and RMSE of the same 20 runs are the same, of 70 are not.
  const auto without_cpu = [](const std::string& numbers) {
    return numbers.substr(0, numbers.find("  ", numbers.find(']') + 8));
  };
  EXPECT_EQ(without_cpu(numbers_of(called.out, "a ")),
            without_cpu(numbers_of(called.out, "mine (yours) ")))
      << called.out;
  EXPECT_THAT(called.out, HasSubstr("over the 20 runs that yours has too"));
  EXPECT_THAT(called.out, HasSubstr("verdicts and CPU/run, which are over all of theirs"));
  EXPECT_THAT(called.out, HasSubstr("Runs in each comparison: 20."));
}

TEST_F(Benchmark, SaysBeforeTheTablesWhereYoursIsBetter) {
  ASSERT_EQ(run("out", {"--world", "corridor_hard"}).code, 0);
  const Called called =
      call({"compare", "out/corridor_hard/a.h5", "--archive", "--entries", "out"});
  EXPECT_THAT(called.out, StartsWith("a against a: undecided: position_rmse, heading_rmse, "
                                     "NEES ratio.\na against b: position_rmse better"));
  // Dead reckoning has the larger error: yours minus that is negative, and most runs are won.
  EXPECT_THAT(called.out, ContainsRegex("against +a minus that \\[95 %\\] +ratio +runs a won"));
  EXPECT_THAT(called.out,
              ContainsRegex("position_rmse \\[m\\] +b +-[0-9].* 0\\.[0-9]+ +[89][0-9]"));
}

TEST_F(Benchmark, DoesNotCompareAcrossWorldsOrSeeds) {
  ASSERT_EQ(run("out", {"--world", "corridor_easy"}).code, 0);
  ASSERT_EQ(run("other", {"--world", "corridor_hard"}).code, 0);
  expect_refused({"compare", "other/corridor_hard/a.h5", "--archive", "--entries", "out"},
                 "no archived filter ran in its world");
}

}  // namespace
}  // namespace montecarta::experiments
