// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/arguments.hpp"

#include "engine/errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const CommandSpec kSpec{.name = "bake",
                        .summary = "bakes",
                        .operands = {{"DOUGH", 1, 1}, {"TIN", 0, SIZE_MAX}},
                        .options = {{"output", "o", {"OUT"}, "where to"},
                                    {"set", "", {"K=V"}, "", true},
                                    {"hot", "", {}, "quickly"},
                                    {"match", "", {"LO", "HI"}, ""}},
                        .details = {}};

std::string complaint_about(const std::vector<std::string>& words) {
  try {
    const Arguments arguments(kSpec, words);
  } catch (const StudyError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Arguments, AreOptionsAndOperandsInAnyOrder) {
  const Arguments arguments(kSpec, {"--set", "a=1", "rye", "-o", "bread", "--hot", "--set=b=2",
                                    "tin", "--match", "1", "2"});
  EXPECT_THAT(arguments.operands(), ElementsAre("rye", "tin"));
  EXPECT_EQ(arguments.text("output"), "bread");
  EXPECT_TRUE(arguments.has("hot"));
  EXPECT_THAT(arguments.texts("set"), ElementsAre("a=1", "b=2"));
  EXPECT_THAT(arguments.texts("match"), ElementsAre("1", "2"));
}

TEST(Arguments, AreRefusedWhereTheyAreNotWhatTheCommandTakes) {
  EXPECT_THAT(complaint_about({}), HasSubstr("DOUGH is missing"));
  EXPECT_THAT(complaint_about({"rye", "--outptu", "x"}), HasSubstr("did you mean --output?"));
  EXPECT_THAT(complaint_about({"rye", "--out", "x"}), HasSubstr("--out: unknown option"))
      << "no guessing";
  EXPECT_THAT(complaint_about({"rye", "--hot", "--hot"}), HasSubstr("--hot: given 2 times"));
  EXPECT_THAT(complaint_about({"rye", "-o", "a", "-o", "b"}), HasSubstr("--output: given 2 times"));
  EXPECT_THAT(complaint_about({"rye", "--match", "1"}), HasSubstr("--match: 1 values"));
  EXPECT_THAT(complaint_about({"rye", "-o"}), testing::StartsWith("bake: "));
}

TEST(Arguments, ReadNumbersWithinLimits) {
  const Arguments arguments(kSpec, {"rye", "-o", "7", "--set", "2.5"});
  EXPECT_EQ(arguments.count("output", 1, 9), 7U);
  EXPECT_EQ(arguments.number("set", 0.0, 9.0), 2.5);
  EXPECT_EQ(arguments.number("match", 0.0, 9.0), std::nullopt);
  EXPECT_THROW(arguments.count("output", 8, 9), StudyError);
  EXPECT_THROW(arguments.count("set", 0, 9), StudyError);
}

TEST(Help, NamesEveryOption) {
  const std::string help = help_text(kSpec);
  EXPECT_THAT(help, HasSubstr("usage: montecarta bake DOUGH TIN... [options]"));
  EXPECT_THAT(help, HasSubstr("-o, --output OUT"));
  EXPECT_THAT(help, HasSubstr("--match LO HI"));
}

TEST(ShellQuoted, ReadsBackAsOneWord) {
  EXPECT_EQ(shell_quoted("a/b-c.h5"), "a/b-c.h5");
  EXPECT_EQ(shell_quoted("a b"), "'a b'");
  EXPECT_EQ(shell_quoted("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_quoted(""), "''");
}

}  // namespace
}  // namespace montecarta::experiments
