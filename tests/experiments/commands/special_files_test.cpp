// SPDX-License-Identifier: BSD-3-Clause
// What is no regular file is refused: a pipe would be waited for.
#include "tests/experiments/commands/program.hpp"

#include <gmock/gmock.h>

#include <filesystem>

namespace montecarta::experiments {
namespace {

using ::testing::HasSubstr;

class SpecialFiles : public Program {
 protected:
  SpecialFiles() {
    write("blink.ini", kBlink);
    write("blink.csv", kBlinkWorld);
  }

  void expect_refused(const std::vector<std::string>& words) const {
    const Called called = call(words, "mkfifo -m 600 pipe.h5 2> stderr; timeout 20 ");
    EXPECT_EQ(called.code, 2) << testing::PrintToString(words) << called.err;
    EXPECT_THAT(called.err, HasSubstr(".h5: ")) << testing::PrintToString(words);
  }
};

TEST_F(SpecialFiles, AreNoResults) {
  expect_refused({"info", "pipe.h5"});
  expect_refused({"status", "pipe.h5"});
  expect_refused({"analyze", "pipe.h5"});
  expect_refused({"compare", "pipe.h5"});
  expect_refused({"verify", "pipe.h5"});
  expect_refused({"report", "pipe.h5", "-o", "report"});
  expect_refused({"replay", "pipe.h5", "--cell", "ekf_slam", "--run", "0", "-o", "replay.h5"});
  expect_refused({"merge", "out.h5", "pipe.h5", "pipe.h5"});
  expect_refused({"run", "blink.ini", "--resume", "-o", "pipe.h5"});
}

// --force replaces a result, and nothing else: the pipe is still one afterwards.
TEST_F(SpecialFiles, AreNotReplaced) {
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
}

TEST_F(SpecialFiles, AreNoTables) {
  ASSERT_EQ(call({"run", "blink.ini", "-o", "whole.h5", "--quiet"}).code, 0);
  const Called called = call({"analyze", "whole.h5", "--csv", ".", "--force"},
                             "mkfifo -m 600 cells.csv; timeout 20 ");
  EXPECT_EQ(called.code, 2) << called.err;
}

}  // namespace
}  // namespace montecarta::experiments
