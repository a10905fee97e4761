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

}  // namespace
}  // namespace montecarta::experiments
