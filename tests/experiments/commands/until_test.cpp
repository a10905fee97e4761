// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/text/words.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/same_results.hpp"
#include "tests/experiments/commands/program.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace montecarta::experiments {
namespace {

/// log(nees_ratio_upper / nees_ratio_lower) of the first row of a cells.csv.
double ratio_width(const std::string& csv) {
  std::istringstream lines(csv);
  std::string names, values;
  std::getline(lines, names);
  std::getline(lines, values);
  const std::vector<std::string> columns = split(names, ',');
  const auto column = [&](const std::string& name) {
    const auto at = std::ranges::find_if(
        columns, [&](const std::string& one) { return one.starts_with(name); });
    return static_cast<std::size_t>(at - columns.begin());
  };
  // A verdict may have commas, and stands in quotes then; numbers have none.
  std::vector<std::string> row = split(values, ',');
  const std::size_t more = row.size() - columns.size();
  const auto number = [&](const std::string& name) {
    return std::stod(row.at(column(name) + more));
  };
  return std::log(number("nees_ratio_upper") / number("nees_ratio_lower"));
}

/// A study that stops as soon as enough is known of a cell.
class Until : public BlinkProgram {
 protected:
  using BlinkProgram::BlinkProgram;
  Called run(const std::string& output, const std::vector<std::string>& more = {}) const {
    return call_with({"run", "blink.ini", "-o", output, "--quiet"}, more);
  }
  void expect_same_bits(const std::string& a, const std::string& b) const {
    EXPECT_EQ(difference(ResultFile(folder_ / a), ResultFile(folder_ / b)), "") << b;
  }
  /// The study runs on any number of threads, and is killed at some moments.
  void expect_same_bits_however_run(const std::vector<std::string>& seconds) const {
    ASSERT_EQ(run("one.h5", {"--threads", "1"}).code, 0);
    ASSERT_EQ(run("two.h5", {"--threads", "2"}).code, 0);
    expect_same_bits("one.h5", "two.h5");
    for (const std::string& after : seconds) {
      const std::string killed = "killed" + after + ".h5";
      call({"run", "blink.ini", "-o", killed, "--quiet"}, "timeout -s KILL " + after + " ");
      ASSERT_EQ(run(killed, {"--resume"}).code, 0);
      expect_same_bits("one.h5", killed);
    }
  }
};

/// Precise to a half-width between those of 32 and of 200 runs, so that it is not enough at once.
class UntilPrecise : public Until {
 protected:
  UntilPrecise() : Until("[study]\nuntil = position_rmse < 0.01\n" + kBlink) {
    std::string study = text_of("blink.ini");
    write("blink.ini", study.replace(study.find("runs = 3"), 8, "runs = 200"));
  }
};

TEST_F(UntilPrecise, IsShownWhereverRunsAreCounted) {
  const Called ran = run("out.h5", {"--set", "study.until=position_rmse < 100"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(call({"status", "out.h5"}).out, ContainsRegex("ekf_slam +32 +0 +0 +200 +168"));
  EXPECT_THAT(call({"info", "out.h5"}).out, ContainsRegex("32 +0 +0 +168"));
  EXPECT_THAT(call({"analyze", "out.h5"}).out, HasSubstr("32 of 200"));
  EXPECT_EQ(call({"verify", "out.h5", "--sample", "3"}).code, 0);
  EXPECT_THAT(call({"verify", "out.h5", "--sample", "1000"}).out, HasSubstr("out of 64 stored"));
}

TEST_F(UntilPrecise, GivesTheSameBitsOnAnyThreadsKilledAndResumed) {
  expect_same_bits_however_run({"0.05", "0.2"});
  EXPECT_THAT(call({"status", "one.h5"}).out, ContainsRegex(" (64|128) +0 +0 +200 +(136|72)\n"));
}

/// The same study in the world that its filters assume: dead reckoning as it is, and one that
/// believes half of the noise.
class UntilVerdict : public Until {
 protected:
  UntilVerdict()
      : Until(
            "[study]\nname = blink\nruns = 500\nuntil = verdict\nwithin = 1.3\n[scenario]\n"
            "world = blink.csv\nnoise = matched\n[cells]\ncell = dead_reckoning label=right\n"
            "cell = dead_reckoning label=too_sure motion_noise=0.5\n") {}
};

TEST_F(UntilVerdict, StopsACellWhenItIsKnownAndSaysAtWhichLook) {
  const Called ran = run("out.h5");
  ASSERT_EQ(ran.code, 0) << ran.err;
  setenv("COLUMNS", "1000", 1);  // no line of the table is folded
  const std::string out = call({"analyze", "out.h5", "--table", "verdict"}).out;
  unsetenv("COLUMNS");
  EXPECT_THAT(out, ContainsRegex("too_sure +(32|64) complete, stopped at (32|64) of 500: verdict "
                                 "known, interim analysis [12] of 5"));
  EXPECT_THAT(out, ContainsRegex("right +500 complete.*consistent within 1.3"));
  EXPECT_THAT(out, HasSubstr("error probability is spent over these"));
  EXPECT_EQ(call({"gate", "out.h5", "--cell", "right"}).code, 0);
  EXPECT_EQ(call({"gate", "out.h5", "--cell", "too_sure"}).code, 4);
}

// The last look has nearly the whole error probability, so the interval of a file that was looked
// at several times is hardly wider than that of a study that was not.
TEST_F(UntilVerdict, WidensTheIntervalOfTheFileALittle) {
  ASSERT_EQ(run("looked.h5", {"--set", "study.within=1.001"}).code, 0);
  ASSERT_EQ(run("once.h5", {"--set", "study.within=1.001", "--set", "study.until="}).code, 0);
  const auto width = [&](const std::string& name) {
    const std::string csv = name + "_csv";
    EXPECT_EQ(call({"analyze", name, "--csv", csv}).code, 0);
    return ratio_width(text_of(csv + "/cells.csv"));
  };
  const double wider = width("looked.h5") / width("once.h5");
  EXPECT_GT(wider, 1.01);
  EXPECT_LT(wider, 1.1);
}

TEST_F(UntilVerdict, NeedsThreeHundredRunsToCallAFilterConsistentUnlessTold) {
  ASSERT_EQ(run("wide.h5", {"--set", "study.within=3"}).code, 0);
  EXPECT_THAT(call({"status", "wide.h5"}).out, ContainsRegex("right +500 "));
  const std::vector<std::string> sooner = {"--set", "study.within=3", "--set",
                                           "study.until=verdict, 100 runs"};
  ASSERT_EQ(run("sooner.h5", sooner).code, 0);
  EXPECT_THAT(call({"status", "sooner.h5"}).out, ContainsRegex("right +(128|256) "));
  expect_refused({"run", "blink.ini", "-o", "x.h5", "--set", "study.until=verdict, some runs"},
                 "until = verdict, 100 runs");
}

TEST_F(UntilVerdict, GivesTheSameBitsOnAnyThreadsKilledAndResumed) {
  expect_same_bits_however_run({"0.1", "0.3"});
}

}  // namespace
}  // namespace montecarta::experiments
