// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/random/stream.hpp"
#include "engine/records/result_file.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/experiments/commands/program.hpp"

#include <functional>
#include <sstream>

namespace montecarta::experiments {
namespace {

/// The world that filters assume: one filter of the right noise, one that believes half of it.
const std::string kMatchedBlink = R"([study]
name = blink
runs = 100
[scenario]
world = blink.csv
noise = matched
[cells]
cell = dead_reckoning label=right
cell = dead_reckoning label=too_sure motion_noise=0.5
)";

class GateOfAFile : public BlinkProgram {
 protected:
  GateOfAFile() : BlinkProgram(kMatchedBlink) {}
  void run(const std::vector<std::string>& settings = {}) const {
    std::vector<std::string> words = {"run", "blink.ini", "-o", "out.h5", "--quiet", "--force"};
    for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
    const Called called = call(words);
    ASSERT_EQ(called.code, 0) << called.err;
  }
  Called gate(const std::string& cell, const std::vector<std::string>& more = {}) const {
    return call_with({"gate", "out.h5", "--cell", cell}, more);
  }
};

TEST_F(GateOfAFile, TellsByItsExitCode) {
  run();
  const Called right = gate("right", {"--within", "2"});
  EXPECT_EQ(right.code, 0) << right.out << right.err;
  EXPECT_THAT(right.out, ContainsRegex("^right is consistent within 2 in every component"));
  const Called too_sure = gate("too_sure", {"--within", "1.5"});
  EXPECT_EQ(too_sure.code, 4);
  EXPECT_THAT(
      too_sure.out,
      ContainsRegex("^too_sure is optimistic .overconfident.: on average its squared errors "
                    "are [3-5]"));
  const Called open = gate("right", {"--within", "1.01"});
  EXPECT_EQ(open.code, 5);
  EXPECT_THAT(open.out, ContainsRegex("undecided: no fault is shown, and 100 runs are too few .* "
                                      "about [0-9]+ more runs decide"));
  for (const char* code : {"0 shown", "4 not", "5 too few"}) {
    EXPECT_THAT(call({"gate", "--help"}).out, HasSubstr(code));
  }
  EXPECT_THAT(call({"judge", "--help"}).out, HasSubstr("montecarta gate OUT.h5"));
}

TEST_F(GateOfAFile, AsksForTheMarginOfTheStudy) {
  run({"study.within=2"});
  EXPECT_EQ(gate("right").code, 0);
}

TEST_F(GateOfAFile, NamesWhatItCannotJudge) {
  run({"study.runs=20"});
  expect_refused({"gate", "out.h5", "--cell", "rigth"}, "did you mean right?");
  expect_refused({"gate", "out.h5"}, "--cell CELL");
  expect_refused({"gate", "out.h5", "--cell", "right", "--within", "1"}, "--within 1: not usable");
  run({"study.runs=20", "record.columns=pose"});
  expect_refused({"gate", "out.h5", "--cell", "right"}, "out.h5: cell right: no errors to judge");
}

TEST_F(GateOfAFile, NeedsNoNameOfTheOnlyCell) {
  write("blink.ini",
        kMatchedBlink.substr(0, kMatchedBlink.find("cell = dead_reckoning label=too")));
  run({"study.runs=20"});
  EXPECT_EQ(call({"gate", "out.h5", "--within", "3"}).code, gate("right", {"--within", "3"}).code);
  EXPECT_NE(call({"gate", "out.h5", "--within", "3"}).code, 2);
}

TEST_F(GateOfAFile, WantsAllRuns) {
  call({"run", "blink.ini", "-o", "out.h5", "--quiet", "--set", "study.runs=100000",
        "--time-budget", "0.2"});
  expect_refused({"gate", "out.h5", "--cell", "right"}, "runs of cell right are missing");
}

/// The numbers of files and of their rows.
struct Size {
  int runs = 60, scans = 32;
};

/// Error and variance of one component at one scan, from a standard normal number.
struct Sample {
  double error, variance;
};

/// Estimates of one component with the true value 0, judged by the program.
class GateOfEstimates : public Program {
 protected:
  Called gate(const std::function<Sample(int run, double normal)>& sample,
              const std::vector<std::string>& more = {}, const Size& size = {}) const {
    RngStream draw({17, 0, 0, 0, Draw::test});
    std::vector<std::string> words = {"judge"};
    for (int run = 0; run < size.runs; ++run) {
      std::ostringstream text;
      text << "time_s,a_m,cov_0_0\n";
      for (int scan = 1; scan <= size.scans; ++scan) {
        const auto [error, variance] = sample(run, draw.normal());
        text << scan << ',' << error << ',' << variance << '\n';
      }
      words.push_back("e_" + std::to_string(1000 + run) + ".csv");
      write(words.back(), text.str());
    }
    std::string truth = "time_s,a_m\n";
    for (int scan = 1; scan <= size.scans; ++scan) truth += std::to_string(scan) + ",0\n";
    write("truth.csv", truth);
    words.insert(words.end(),
                 {"--truth", "truth.csv", "--error", "world", "-o", "mine.h5", "--force"});
    const Called judged = call(words);
    EXPECT_EQ(judged.code, 0) << judged.err;
    return call_with({"gate", "mine.h5", "--within", "1.5"}, more);
  }
};

TEST_F(GateOfEstimates, LetsARightCovariancePass) {
  const Called called = gate([](int, double n) { return Sample{n, 1.0}; });
  EXPECT_EQ(called.code, 0) << called.out << called.err;
  EXPECT_EQ(call({"analyze", "mine.h5"}).code, 0);
}

// An error with a square that no double holds is no invalid covariance.
TEST_F(GateOfEstimates, StopsDivergenceBeyondTheRangeOfDoubles) {
  const Called called = gate(
      [](int run, double n) {
        return Sample{run < 58 ? 1e200 : n, 1.0};
      },
      {"--invalid", "9"});
  EXPECT_EQ(called.code, 4) << called.out << called.err;
  EXPECT_THAT(called.out, HasSubstr("optimistic"));
}

TEST_F(GateOfEstimates, StopsNegativeVariances) {
  const auto negative = [](int run, double n) { return Sample{n, run < 56 ? -1.0 : 1.0}; };
  const Called called = gate(negative);
  EXPECT_EQ(called.code, 4) << called.out << called.err;
  EXPECT_THAT(called.out, HasSubstr("1792 of 1920 samples are unusable"));
  EXPECT_NE(gate(negative, {"--invalid", "1792", "--failed", "56"}).code, 4);
}

TEST_F(GateOfEstimates, StopsAVarianceOfZeroWhereTheErrorIsLarge) {
  const Called called = gate([](int, double n) {
    return Sample{n, std::abs(n) > 1.2 ? 0.0 : 0.46};
  });
  EXPECT_EQ(called.code, 4) << called.out << called.err;
  EXPECT_THAT(called.out, HasSubstr("claims a deviation of 0 for a"));
}

// Few runs, or runs that hardly differ, leave no double for the tails that the verdict asks for.
TEST_F(GateOfEstimates, AnswersWhereRunsAreFewOrAlike) {
  constexpr auto npos = std::string::npos;
  double of_run = 0.0;
  const auto constant_in_a_run = [&, last = -1](int run, double n) mutable {
    if (run != last) of_run = n;
    last = run;
    return Sample{of_run, 1.0};
  };
  const auto identical = [](int, double) { return Sample{1.0, 1.0}; };
  const auto zero = [](int, double) { return Sample{0.0, 1.0}; };
  const auto right = [](int, double n) { return Sample{n, 1.0}; };
  for (const Size& size :
       {Size{1, 1}, Size{2, 1}, Size{3, 1}, Size{3, 8}, Size{4, 2}, Size{20, 1}}) {
    for (const auto& sample : std::vector<std::function<Sample(int, double)>>{
             constant_in_a_run, identical, zero, right}) {
      const Called called = gate(sample, {}, size);
      const bool are_repeated = called.code == 2 && called.err.find("are those of run") != npos;
      EXPECT_TRUE(called.code == 0 || called.code == 4 || called.code == 5 || are_repeated)
          << size.runs << " runs of " << size.scans << ": " << called.err;
    }
  }
}

const std::string kStudy = R"([study]
name = dead
runs = 300
[scenario]
world = blink.csv
speed = 1
sigma_range = 0.1
[cells]
cell = dead_reckoning label=dead
)";

class DeadReckoning : public Program {
 protected:
  /// The average NEES of the first scans is where one of a million consistent filters is not.
  void expect_consistent_beginning(const std::string& what) const {
    const auto cell = analysis::analyze(ResultFile(folder_ / "out.h5")).cells.at(0);
    const auto* pose = cell.find_nees(analysis::ErrorBlock::pose, cell.leading);
    ASSERT_NE(pose, nullptr);
    const analysis::Interval band = analysis::nees_bounds(300, 3, 1.0 - 1e-6);
    for (std::size_t s = 0; s < 3; ++s) {
      EXPECT_GT(pose->series.average[s], band.lower) << "scan " << s << " of " << what;
      EXPECT_LT(pose->series.average[s], band.upper) << "scan " << s << " of " << what;
    }
  }
};

// Law: dead reckoning is consistent for every vehicle, noise and pair of rates. With one control
// step before a scan the covariance of two controls has rank 2.
TEST_F(DeadReckoning, IsConsistentFromTheFirstScanOn) {
  write("dead.ini", kStudy);
  write("blink.csv", kBlinkWorld);
  const std::vector<std::vector<std::string>> vehicles = {
      {"vehicle=front_axle", "sigma_speed=0.1"},
      {"vehicle=rear_wheel", "sigma_speed=0.1"},
      {"vehicle=differential_drive", "sigma_speed=0.1", "integration=arc"},
      {"vehicle=differential_drive", "sigma_speed=0.1", "integration=euler"},
      {"vehicle=omnidirectional", "integration=arc"},
      {"vehicle=omnidirectional", "integration=euler"}};
  for (const std::vector<std::string>& vehicle : vehicles) {
    for (const char* noise : {"noise=matched", "noise=measured-control"}) {
      for (const char* rate : {"control_rate=1", "control_rate=2"}) {
        std::vector<std::string> settings = vehicle;
        settings.insert(settings.end(), {noise, rate, "scan_rate=1"});
        std::vector<std::string> words = {"run", "dead.ini", "-o", "out.h5", "--quiet", "--force"};
        for (const std::string& setting : settings) {
          words.insert(words.end(), {"--set", "scenario." + setting});
        }
        const Called called = call(words);
        ASSERT_EQ(called.code, 0) << called.err;
        expect_consistent_beginning(testing::PrintToString(settings));
      }
    }
  }
}

}  // namespace
}  // namespace montecarta::experiments
