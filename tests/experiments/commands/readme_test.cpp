// SPDX-License-Identifier: BSD-3-Clause
#include "tests/experiments/commands/program.hpp"

#include <fstream>
#include <regex>

namespace montecarta::experiments {
namespace {

using testing::HasSubstr;

/// The lines of the README that are indented as output of the program, below a heading, without
/// their indentation.
std::vector<std::string> output_below(const std::string& heading) {
  std::ifstream readme(MONTECARTA_SOURCE_DIR "/README.md");
  std::vector<std::string> output;
  bool is_below = false;
  for (std::string line; std::getline(readme, line);) {
    if (line.starts_with("## ")) is_below = line == "## " + heading;
    if (is_below && line.starts_with("    ")) output.push_back(line.substr(4));
  }
  return output;
}

/// Text without the processor times, which end the rows of the table.
std::string without_times(const std::string& text) {
  static const std::regex time(R"( +[0-9.]+\n)");
  return std::regex_replace(text, time, "\n");
}

class Readme : public Program {};

TEST_F(Readme, SlowHasTheFirstVerdictOfTheProgram) {
  const std::string study = MONTECARTA_SOURCE_DIR "/experiments/studies/first_study.ini";
  const Called called = call({"run", study, "-o", "first_study.h5"}, "export COLUMNS=80 && ");
  ASSERT_EQ(called.code, 0) << called.err;
  const std::string printed = without_times(called.out);
  const std::vector<std::string> shown = output_below("What the first verdict means");
  ASSERT_GE(shown.size(), 8U);
  for (const std::string& line : shown) EXPECT_THAT(printed, HasSubstr(without_times(line + "\n")));
}

}  // namespace
}  // namespace montecarta::experiments
