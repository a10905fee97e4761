// SPDX-License-Identifier: BSD-3-Clause
// What the scripts of cluster/ call: run --attempt, and status --each.
#include "tests/experiments/commands/program.hpp"

#include <gmock/gmock.h>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::StartsWith;

class AttemptCommand : public Program {
 protected:
  AttemptCommand() {
    write("blink.ini", kBlink);
    write("blink.csv", kBlinkWorld);
  }
  Called attempt(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"run", "blink.ini", "-o", "out.h5", "--attempt", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return call(words);
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

}  // namespace
}  // namespace montecarta::experiments
