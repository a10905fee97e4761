// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/gnuplot.hpp"

#include "engine/errors.hpp"
#include "engine/visible_text.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace montecarta::analysis {
namespace {

/// Where a process begins: its folder, and where its words go.
class SpawnActions {
 public:
  SpawnActions(const std::filesystem::path& directory, const std::filesystem::path& log) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
    posix_spawn_file_actions_addchdir_np(&actions_, directory.c_str());
  }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

/// The last line that says something.
std::string last_lines(const std::filesystem::path& log) {
  std::ifstream file(log);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (line.find_first_not_of(" \t^") != std::string::npos) last = line;
  }
  return last.empty() ? "it says nothing" : last;
}

int wait_for(pid_t process) {
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

void run_gnuplot(const std::filesystem::path& directory, const std::string& name,
                 const std::string& program) {
  const auto log = std::filesystem::absolute(directory) / (name + ".log");
  const SpawnActions actions(directory, log);
  std::string words[] = {program, name};
  char* const arguments[] = {words[0].data(), words[1].data(), nullptr};
  pid_t process = 0;
  const int error =
      posix_spawnp(&process, program.c_str(), actions.get(), nullptr, arguments, environ);
  if (error == ENOENT) {
    throw StudyError(program +
                     ": not found (it draws the figures): install it, on Debian with 'apt-get "
                     "install gnuplot-nox'");
  }
  if (error != 0) throw RunError(program + ": cannot be started (" + std::strerror(error) + ")");
  const int status = wait_for(process);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw RunError((directory / name).string() + ": gnuplot failed (" + last_lines(log) +
                   "): look at " + log.string());
  }
  std::filesystem::remove(log);
}

std::string gnuplot_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : visible(text)) {
    quoted += c == '\'' ? std::string("''") : std::string(1, c);
  }
  return quoted + "'";
}

}  // namespace montecarta::analysis
