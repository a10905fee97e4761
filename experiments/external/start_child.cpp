// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "experiments/external/child_process.hpp"
#include "experiments/text/words.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <vector>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

struct Pipe {
  Descriptor read, write;
};

/// Beyond the standard ones, so that none of a child's three is in the way of another.
Descriptor beyond_standard(int number) {
  Descriptor first(number);
  if (number > 2) return first;
  return Descriptor(::fcntl(number, F_DUPFD_CLOEXEC, 3));
}

Pipe make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    throw RunError(std::string("no pipe to a program (") + std::strerror(errno) +
                   "): allow more open files (ulimit -n), or use fewer threads");
  Descriptor read = beyond_standard(ends[0]), write = beyond_standard(ends[1]);
  return {std::move(read), std::move(write)};
}

void do_not_wait_for(const Descriptor& descriptor) {
  ::fcntl(descriptor.number(), F_SETFL, O_NONBLOCK);
}

/// Our environment, and what makes interpreters and linear algebra the same from process to process
/// and leaves the other cores to the other workers, unless the user says otherwise.
std::vector<std::string> environment_of_child() {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable)
    variables.emplace_back(*variable);
  for (const char* name :
       {"OMP_NUM_THREADS=1", "OPENBLAS_NUM_THREADS=1", "MKL_NUM_THREADS=1", "PYTHONHASHSEED=0"}) {
    const std::string variable = name;
    if (std::getenv(variable.substr(0, variable.find('=')).c_str()) == nullptr)
      variables.push_back(variable);
  }
  return variables;
}

/// As execve() takes them.
std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// What posix_spawn() is told.
class SpawnOrders {
 public:
  SpawnOrders() {
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawnattr_init(&attributes_);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    ::posix_spawnattr_setsigdefault(&attributes_, &all);
    ::posix_spawnattr_setpgroup(&attributes_, 0);
    ::posix_spawnattr_setflags(
        &attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnOrders() {
    ::posix_spawn_file_actions_destroy(&actions_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  SpawnOrders(const SpawnOrders&) = delete;
  SpawnOrders& operator=(const SpawnOrders&) = delete;

  void give(int input, int output, int error) {
    ::posix_spawn_file_actions_adddup2(&actions_, input, STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions_, error, STDERR_FILENO);
    ::posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
  }
  const posix_spawn_file_actions_t* actions() const { return &actions_; }
  const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

bool may_be_run(const fs::path& file) {
  std::error_code failure;
  return fs::is_regular_file(file, failure) && ::access(file.c_str(), X_OK) == 0;
}

}  // namespace

fs::path find_program(const std::string& program) {
  if (program.find('/') != std::string::npos) {
    if (may_be_run(program)) return program;
  } else {
    const char* path = std::getenv("PATH");
    for (const std::string& folder : split(path == nullptr ? "/usr/bin:/bin" : path, ':')) {
      fs::path file = fs::path(folder.empty() ? "." : folder) / program;
      if (may_be_run(file)) return file;
    }
  }
  throw StudyError("program '" + program +
                   "' (there is no such file that may be run, here or in $PATH): correct the "
                   "command, install the program, or chmod +x it");
}

ChildProcess::ChildProcess(std::span<const std::string> words) {
  Pipe input = make_pipe(), output = make_pipe(), error = make_pipe();
  start(words, input.read.number(), output.write.number(), error.write.number());
  process_handle_ = Descriptor(static_cast<int>(::syscall(SYS_pidfd_open, process_, 0)));
  input_ = std::move(input.write);
  output_ = std::move(output.read);
  error_ = std::move(error.read);
  for (const Descriptor* ours : {&input_, &output_, &error_}) do_not_wait_for(*ours);
}

void ChildProcess::start(std::span<const std::string> words, int input, int output, int error) {
  std::vector<std::string> arguments(words.begin(), words.end());
  std::vector<std::string> variables = environment_of_child();
  SpawnOrders orders;
  orders.give(input, output, error);
  const int failure =
      ::posix_spawnp(&process_, arguments.front().c_str(), orders.actions(), orders.attributes(),
                     pointers_to(arguments).data(), pointers_to(variables).data());
  if (failure == 0) return;
  throw RunError("program '" + words.front() + "' cannot be started (" + std::strerror(failure) +
                 "): a script needs a first line like #!/usr/bin/python3; else free memory, or use "
                 "fewer threads");
}

}  // namespace montecarta::experiments
