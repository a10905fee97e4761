// SPDX-License-Identifier: BSD-3-Clause
#include "tests/experiments/commands/program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

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

class GateOfAFile : public Program {
 protected:
  GateOfAFile() {
    write("blink.ini", kMatchedBlink);
    write("blink.csv", kBlinkWorld);
  }
  void run(const std::vector<std::string>& settings = {}) const {
    std::vector<std::string> words = {"run", "blink.ini", "-o", "out.h5", "--quiet", "--force"};
    for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
    const Called called = call(words);
    ASSERT_EQ(called.code, 0) << called.err;
  }
  Called gate(const std::string& cell, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"gate", "out.h5", "--cell", cell};
    words.insert(words.end(), more.begin(), more.end());
    return call(words);
  }
};

TEST_F(GateOfAFile, TellsByItsExitCode) {
  run();
  const Called right = gate("right", {"--within", "1.5"});
  EXPECT_EQ(right.code, 0) << right.out << right.err;
  EXPECT_THAT(right.out, ContainsRegex("^right: consistent within 1.5; .*100 runs\n$"));
  const Called too_sure = gate("too_sure", {"--within", "1.5"});
  EXPECT_EQ(too_sure.code, 4);
  EXPECT_THAT(too_sure.out, ContainsRegex("^too_sure: not consistent, optimistic by [3-5]"));
  const Called open = gate("right", {"--within", "1.01"});
  EXPECT_EQ(open.code, 5);
  EXPECT_THAT(open.out, ContainsRegex("undecided: [0-9]+ more runs decide"));
  for (const char* code : {"0 shown", "4 not", "5 too few"}) {
    EXPECT_THAT(call({"gate", "--help"}).out, HasSubstr(code));
  }
}

TEST_F(GateOfAFile, AsksForTheMarginOfTheStudy) {
  run({"study.within=1.5"});
  EXPECT_EQ(gate("right").code, 0);
}

TEST_F(GateOfAFile, NamesWhatItCannotJudge) {
  const auto complaint = [&](const Called& called) {
    EXPECT_EQ(called.code, 2);
    EXPECT_EQ(called.out, "");
    return called.err;
  };
  run({"study.runs=20"});
  EXPECT_THAT(complaint(gate("rigth")), HasSubstr("did you mean right?"));
  EXPECT_THAT(complaint(call({"gate", "out.h5"})), ContainsRegex("--cell CELL.*right, too_sure"));
  EXPECT_THAT(complaint(gate("right", {"--within", "1"})), HasSubstr("--within 1: not usable"));
  run({"study.runs=20", "record.columns=pose"});
  EXPECT_THAT(complaint(gate("right")), ContainsRegex("out.h5: cell right: no NEES to judge"));
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
  const Called called = gate("right");
  EXPECT_EQ(called.code, 2);
  EXPECT_THAT(called.err, ContainsRegex("runs of cell right are missing.*--resume"));
}

}  // namespace
}  // namespace montecarta::experiments
