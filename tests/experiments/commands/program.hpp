// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/text/visible_text.hpp"
#include "experiments/commands/arguments.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace montecarta::experiments {

/// Exit code and output of a call of the real executable.
struct Called {
  int code = -1;
  std::string out;  ///< standard output
  std::string err;  ///< standard error
};

/// The program under test: that of this build, or the one that MONTECARTA_PROGRAM names.
inline std::string program_under_test() {
  const char* other = std::getenv("MONTECARTA_PROGRAM");
  return other == nullptr ? MONTECARTA_EXECUTABLE : other;
}

/// A folder of its own for each test, in which the program is called.
class Program : public testing::Test {
 protected:
  Program() {
    const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = std::filesystem::temp_directory_path() /
              ("montecarta_program_" + test + "_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~Program() override { std::filesystem::remove_all(folder_); }

  /// `before`: shell commands that go first.
  Called call(const std::vector<std::string>& words, const std::string& before = "") const {
    std::string line = "cd ";  // append() throughout: g++ 12 sees an overrun in " " + std::string
    line.append(shell_quoted(folder_.string()));
    line.append(" && export COLUMNS=1000 && ").append(before);  // sentences stand on one line
    line.append(shell_quoted(program_under_test()));
    for (const std::string& word : words) line.append(" ").append(shell_quoted(word));
    line.append(" 2>").append(shell_quoted((folder_ / "stderr").string()));
    Called called;
    std::FILE* pipe = ::popen(line.c_str(), "r");
    std::array<char, 4096> buffer;
    for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
      called.out.append(buffer.data(), n);
    }
    const int status = ::pclose(pipe);
    called.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    called.err = text_of("stderr");
    return called;
  }

  /// Calls the program and kills it with -9 as soon as a file of this pattern is there. Returns
  /// whether it was killed, and did not end before.
  bool is_killed_at(const std::string& pattern, const std::vector<std::string>& words) const {
    std::string line =
        "cd " + shell_quoted(folder_.string()) + "\n" + shell_quoted(program_under_test());
    for (const std::string& word : words) line.append(" ").append(shell_quoted(word));
    line += " >killed.out 2>&1 &\nwhile kill -0 $! 2>/dev/null && ! compgen -G '" + pattern +
            "' >/dev/null; do :; done\nkill -9 $! 2>/dev/null\nwait $! 2>/dev/null\n"
            "[ $? -eq 137 ]";
    return std::system(("bash -c " + shell_quoted(line)).c_str()) == 0;
  }

  /// The same with more words behind.
  Called call_with(std::vector<std::string> words, const std::vector<std::string>& more) const {
    words.insert(words.end(), more.begin(), more.end());
    return call(words);
  }
  /// The call must end as wrong input, saying `words` and nothing else.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& words) const {
    const Called called = call(arguments);
    EXPECT_EQ(called.code, 2) << called.err;
    EXPECT_THAT(called.err, testing::HasSubstr(words));
    EXPECT_EQ(called.out, "");
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  std::string text_of(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }

  std::filesystem::path folder_;
};

/// A study that takes a blink: one short line and back.
inline const std::string kBlink = R"([study]
name = blink
runs = 3
[scenario]
world = blink.csv
[cells]
cell = ekf_slam
cell = fastslam2 particles=10
)";
inline const std::string kBlinkWorld =
    "kind,x,y\nwaypoint,10,0\nwaypoint,20,1\nlandmark,15,5\nlandmark,25,-4\n";

/// A folder that holds this study and its world.
class BlinkProgram : public Program {
 protected:
  explicit BlinkProgram(const std::string& study = kBlink) {
    write("blink.ini", study);
    write("blink.csv", kBlinkWorld);
  }
};

}  // namespace montecarta::experiments
