// SPDX-License-Identifier: BSD-3-Clause
// Malformed text of studies, tables and other programs.
#include "tests/doubles/matchers.hpp"
#include "tests/experiments/commands/program.hpp"

#include <filesystem>

namespace montecarta::experiments {
namespace {

class HostileText : public BlinkProgram {
 protected:
  Called run(const std::string& study) const {
    write("blink.ini", study);
    return call({"run", "blink.ini", "-o", "out.h5", "--quiet", "--force"});
  }
};

TEST_F(HostileText, Utf16AndNulBytesAreNamedAndAByteOrderMarkIsNoFault) {
  EXPECT_EQ(run("\xEF\xBB\xBF" + kBlink).code, 0);
  std::string wide = "\xFF\xFE";
  for (const char c : kBlink) (wide += c) += '\0';
  EXPECT_EQ(run(wide).code, 2);
  EXPECT_THAT(run(wide).err, HasSubstr("blink.ini: is in UTF-16"));
  write("blink.csv", kBlinkWorld.substr(0, 30) + std::string(1, '\0') + kBlinkWorld.substr(30));
  EXPECT_THAT(run(kBlink).err, ContainsRegex("blink.csv:[0-9]: a NUL byte"));
}

TEST_F(HostileText, ControlCharactersReachNeitherFileNorTerminal) {
  EXPECT_THAT(run(kBlink + "[study]\ntitle = a\x1b[2Jb\n").err,
              AllOf(HasSubstr("title = a\\x1b[2Jb"), Not(HasSubstr("\x1b"))));
  EXPECT_THAT(run(kBlink + "[study]\nk\x1b]0;x\x07 = 1\n").err,
              AllOf(HasSubstr("\\x1b]0;x\\x07"), Not(HasSubstr("\x1b"))));
}

TEST_F(HostileText, LongValuesAreNotEchoed) {
  const std::string longest(100'000, 'x');
  for (const std::string& line :
       {"[study]\nruns = " + longest, "[study]\n" + longest + " = 1", "[study]\nname = " + longest,
        "[cells]\ncell = " + longest, "[cells]\ncell = ekf_slam label=" + longest}) {
    const Called called = run(kBlink + line + "\n");
    EXPECT_EQ(called.code, 2) << line.substr(0, 30);
    EXPECT_LT(called.err.size(), 9000u) << line.substr(0, 30);
    EXPECT_THAT(called.err, HasSubstr("blink.ini:"));
  }
}

TEST_F(HostileText, AWayPointThatIsNotReachedIsNamedByItsLine) {
  EXPECT_THAT(run(kBlink + "[scenario]\nwaypoint_radius = 0.001\n").err,
              ContainsRegex("blink.csv:[23]: way-point [12] is not reached"));
}

TEST_F(HostileText, APageIsMadeOfNumbersBeyondAnyAxis) {
  const std::string header =
      "time_s,x_m,y_m,heading_rad,cov_0_0,cov_0_1,cov_0_2,cov_1_0,cov_1_1,cov_1_2,cov_2_0,cov_2_1,"
      "cov_2_2\n";
  write("e_0.csv", header + "1,1e308,0,0,1,0,0,0,1,0,0,0,1\n2,-1e308,1,0,1,0,0,0,1,0,0,0,1\n");
  write("e_1.csv", header + "1,0,0,0,1,0,0,0,1,0,0,0,1\n2,0,1,0,1,0,0,0,1,0,0,0,1\n");
  write("truth.csv", "time_s,x_m,y_m,heading_rad\n1,0,0,0\n2,0,0,0\n");
  ASSERT_EQ(call({"judge", "e_0.csv", "e_1.csv", "--truth", "truth.csv", "--error", "world", "-o",
                  "mine.h5"})
                .code,
            0);
  const Called called = call({"report", "mine.h5", "-o", "page"});
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_TRUE(exists("page/index.html"));
}

TEST_F(HostileText, AVectorHasOneConvention) {
  write("e_0.csv", "time_s,a_m,cov_0_0\n1,0.5,1\n2,-0.5,1\n");
  write("truth.csv", "time_s,a_m\n1,0\n2,0\n");
  EXPECT_EQ(call({"judge", "e_0.csv", "--truth", "truth.csv", "-o", "mine.h5"}).code, 0);
}

// Only regular files are read: the program would wait for a pipe.
class SpecialFiles : public BlinkProgram {
 protected:
  void expect_refused(const std::vector<std::string>& words) const {
    const Called called = call(words, "mkfifo -m 600 pipe.h5 2> stderr; timeout 20 ");
    EXPECT_EQ(called.code, 2) << testing::PrintToString(words) << called.err;
    EXPECT_THAT(called.err, HasSubstr(".h5: ")) << testing::PrintToString(words);
  }
};

TEST_F(SpecialFiles, AreNoResults) {
  for (const char* command : {"info", "status", "analyze", "compare", "verify"}) {
    expect_refused({command, "pipe.h5"});
  }
  expect_refused({"report", "pipe.h5", "-o", "report"});
  expect_refused({"replay", "pipe.h5", "--cell", "ekf_slam", "--run", "0", "-o", "replay.h5"});
  expect_refused({"merge", "out.h5", "pipe.h5", "pipe.h5"});
  expect_refused({"run", "blink.ini", "--resume", "-o", "pipe.h5"});
}

// --force replaces a result, and nothing else: the pipe is still one afterwards.
TEST_F(SpecialFiles, AreNotReplacedAndAreNoTables) {
  ASSERT_EQ(call({"run", "blink.ini", "-o", "whole.h5", "--quiet"}).code, 0);
  write("e_0.csv", "time_s,a_m,cov_0_0\n1,0.5,1\n");
  write("truth.csv", "time_s,a_m\n1,0\n");
  const std::vector<std::string> judge = {"judge",   "e_0.csv", "--truth", "truth.csv",
                                          "--error", "world",   "--force", "-o"};
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"run", "blink.ini", "--force", "--quiet", "-o"},
           {"replay", "whole.h5", "--cell", "ekf_slam", "--run", "0", "--force", "-o"},
           {"analyze", "whole.h5", "--force", "-o"},
           {"merge", "--force"},
           judge}) {
    for (const char* output : {"pipe.h5", "nowhere.h5", ""}) {
      std::vector<std::string> all = words;
      all.emplace_back(output);
      if (words.front() == "merge") all.emplace_back("whole.h5");
      const Called called =
          call(all, "ln -sf missing/x.h5 nowhere.h5; mkfifo -m 600 pipe.h5 2> stderr; timeout 20 ");
      EXPECT_EQ(called.code, 2) << testing::PrintToString(all) << called.err;
      EXPECT_TRUE(std::filesystem::is_fifo(folder_ / "pipe.h5")) << words.front();
    }
  }
  const Called called = call({"analyze", "whole.h5", "--csv", ".", "--force"},
                             "mkfifo -m 600 cells.csv; timeout 20 ");
  EXPECT_EQ(called.code, 2) << called.err;
}

}  // namespace
}  // namespace montecarta::experiments
