// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/external/child_process.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace montecarta::experiments {
namespace {

constexpr std::size_t kMostGroups = 4096;

/// The main loop of the guard process. It was forked from a process with many threads, so it calls
/// no function that may wait for a lock. It closes the descriptors that it inherited, which belong
/// to the parent and its programs.
[[noreturn]] void guard_until_end_of(int line) {
  ::setsid();  // keeps Ctrl-C in a terminal from reaching it
  ::dup2(line, STDIN_FILENO);
  ::syscall(SYS_close_range, 1U, ~0U, 0U);
  const pid_t ready = 0;
  (void)::send(STDIN_FILENO, &ready, sizeof ready, MSG_NOSIGNAL);
  std::array<pid_t, kMostGroups> groups{};
  std::size_t n = 0;
  for (;;) {
    pid_t told = 0;
    const ssize_t bytes = ::recv(STDIN_FILENO, &told, sizeof told, 0);
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes != sizeof told) break;
    pid_t* const end = groups.data() + n;
    pid_t* const known = std::find(groups.data(), end, -told);
    if (told < 0 && known != end) {
      *known = groups[--n];
    } else if (told > 0 && n < kMostGroups) {
      groups[n++] = told;
    }
  }
  for (std::size_t i = 0; i < n; ++i) ::kill(-groups[i], SIGKILL);
  ::_exit(0);
}

}  // namespace

OrphanGuard& OrphanGuard::instance() {
  static OrphanGuard guard;
  return guard;
}

/// Forks twice, and the process in between ends at once. So the guard is not a child of this
/// process, which would have to wait for it.
OrphanGuard::OrphanGuard() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) return;
  const pid_t between = ::fork();
  if (between == 0) {
    ::close(ends[1]);
    if (::fork() == 0) guard_until_end_of(ends[0]);
    ::_exit(0);
  }
  ::close(ends[0]);
  if (between < 0) {
    ::close(ends[1]);
    return;
  }
  while (::waitpid(between, nullptr, 0) < 0 && errno == EINTR) continue;
  // The guard keeps pipes of other programs open until it has closed the descriptors that it
  // inherited.
  pid_t ready = 0;
  while (::recv(ends[1], &ready, sizeof ready, 0) < 0 && errno == EINTR) continue;
  line_ = ends[1];
}

void OrphanGuard::send(pid_t signed_group) const {
  if (line_ < 0) return;
  // Raises no signal if the guard was killed.
  while (::send(line_, &signed_group, sizeof signed_group, MSG_NOSIGNAL) < 0 && errno == EINTR) {
    continue;
  }
}

namespace {

namespace fs = std::filesystem;

struct Pipe {
  Descriptor read, write;
};

/// Moves a descriptor above the three standard ones, so that it cannot collide with those of a
/// child.
Descriptor beyond_standard(int number) {
  Descriptor first(number);
  if (number > 2) return first;
  return Descriptor(::fcntl(number, F_DUPFD_CLOEXEC, 3));
}

Pipe make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    throw RunError(
        "no pipe to a program ({}): allow more open files (ulimit -n), or use fewer threads",
        std::strerror(errno));
  Descriptor read = beyond_standard(ends[0]), write = beyond_standard(ends[1]);
  return {std::move(read), std::move(write)};
}

/// The environment of this process, with variables that make interpreters and linear algebra
/// reproducible and single-threaded, so that they leave the other cores to the other workers.
/// Variables that the user has set are kept.
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

/// Pointers to the texts and a null pointer at the end, as execve() takes them.
std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// File actions and attributes for posix_spawn().
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

constexpr int kFarewell = 1000;  // [ms] time that a program has to end after its input is closed
constexpr int kLookUp = 50;      // [ms] time between two checks of the stop flag
/// Time for which a worker polls for an answer before it sleeps. Waking it on an idle core takes
/// longer than a scan of a fast filter.
constexpr std::chrono::microseconds kAwake{50};
constexpr std::size_t kErrorOutput = 4096;  // [byte] length that is kept of the standard error

bool is_for_later(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

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
  throw StudyError(
      "program '{}' (there is no such file that may be run, here or in $PATH): correct the "
      "command, install the program, or chmod +x it",
      program);
}

ChildProcess::ChildProcess(std::span<const std::string> words) {
  OrphanGuard::instance();  // started before the pipes exist, because it would inherit them
  // Writing to a program that has ended is then an error of write() instead of the end of this one.
  [[maybe_unused]] static const auto before = std::signal(SIGPIPE, SIG_IGN);
  Pipe input = make_pipe(), output = make_pipe(), error = make_pipe();
  start(words, input.read.number(), output.write.number(), error.write.number());
  process_handle_ = Descriptor(static_cast<int>(::syscall(SYS_pidfd_open, process_, 0)));
  input_ = std::move(input.write);
  output_ = std::move(output.read);
  error_ = std::move(error.read);
  for (const Descriptor* ours : {&input_, &output_, &error_})
    ::fcntl(ours->number(), F_SETFL, O_NONBLOCK);
}

void ChildProcess::start(std::span<const std::string> words, int input, int output, int error) {
  std::vector<std::string> arguments(words.begin(), words.end());
  std::vector<std::string> variables = environment_of_child();
  SpawnOrders orders;
  orders.give(input, output, error);
  const int failure =
      ::posix_spawnp(&process_, arguments.front().c_str(), orders.actions(), orders.attributes(),
                     pointers_to(arguments).data(), pointers_to(variables).data());
  if (failure == 0) return OrphanGuard::instance().guard(process_);
  throw RunError(
      "program '{}' cannot be started ({}): a script needs a first line like #!/usr/bin/python3; "
      "else free memory, or use fewer threads",
      words.front(), std::strerror(failure));
}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(number_, other.number_);
  return *this;
}

void Descriptor::close() {
  if (is_open()) ::close(number_);
  number_ = -1;
}

ChildProcess::~ChildProcess() {
  input_.close();
  if (!failed_) ends_within(kFarewell);
  ::kill(-process_, SIGKILL);  // its number is not reused before the process is reaped
  OrphanGuard::instance().release(process_);
  while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) continue;
}

std::string_view ChildProcess::exchange(std::string_view line, const TimeLimit& time_limit) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::duration<double>(time_limit.seconds);
  incoming_.erase(0, answered_);
  answered_ = 0;
  outgoing_.assign(line).append("\n");
  sent_ = 0;
  send();
  while (sent_ < outgoing_.size() || !has_line()) {
    if (at_end_ && !has_line()) fail_ended();
    if (time_limit.stop != nullptr && time_limit.stop->is_set()) fail("stopped");
    const std::chrono::duration<double, std::milli> left = deadline - Clock::now();
    if (left.count() <= 0.0) fail("program gave no answer within the limit");
    wait_for_events(static_cast<int>(std::clamp(left.count(), 1.0, double{kLookUp})));
    send();
    if (!has_line()) receive();
    if (!has_line() && incoming_.size() > kLongestLine) fail("program's answer is too long");
  }
  answered_ = incoming_.find('\n') + 1;
  return std::string_view(incoming_).substr(0, answered_ - 1);
}

void ChildProcess::wait_for_events(int milliseconds) {
  std::array<pollfd, 3> events{{{at_end_ || has_line() ? -1 : output_.number(), POLLIN, 0},
                                {error_.number(), POLLIN, 0},
                                {sent_ < outgoing_.size() ? input_.number() : -1, POLLOUT, 0}}};
  const auto awake_until = std::chrono::steady_clock::now() + kAwake;
  int ready = 0;
  do {
    ready = ::poll(events.data(), events.size(), 0);
  } while (ready == 0 && std::chrono::steady_clock::now() < awake_until);
  if (ready == 0) ::poll(events.data(), events.size(), milliseconds);
  if (events[1].revents != 0) listen();
}

void ChildProcess::send() {
  if (sent_ == outgoing_.size() || !input_.is_open()) return;
  const ssize_t n = ::write(input_.number(), outgoing_.data() + sent_, outgoing_.size() - sent_);
  if (n >= 0) {
    sent_ += static_cast<std::size_t>(n);
  } else if (!is_for_later(errno)) {
    at_end_ = true;
  }
}

void ChildProcess::receive() {
  std::array<char, 16384> buffer;
  const ssize_t n = ::read(output_.number(), buffer.data(), buffer.size());
  if (n > 0) {
    incoming_.append(buffer.data(), static_cast<std::size_t>(n));
  } else if (n == 0 || !is_for_later(errno)) {
    at_end_ = true;
  }
}

/// Reads the available output of the program's standard error.
void ChildProcess::listen() {
  std::array<char, 4096> buffer;
  const ssize_t n = ::read(error_.number(), buffer.data(), buffer.size());
  if (n > 0) {
    error_output_.append(buffer.data(), static_cast<std::size_t>(n));
    if (error_output_.size() > kErrorOutput)
      error_output_.erase(0, error_output_.size() - kErrorOutput);
  } else if (n == 0 || !is_for_later(errno)) {
    error_.close();
  }
}

void ChildProcess::fail(const std::string& reason) {
  failed_ = true;
  throw ProgramError(reason);
}

/// Fails with the exit status of the program and the last line of its standard error.
void ChildProcess::fail_ended() {
  const std::string how = how_it_ended();
  while (error_.is_open()) {
    pollfd event{error_.number(), POLLIN, 0};
    if (::poll(&event, 1, kLookUp) <= 0) break;
    listen();
  }
  const std::vector<std::string> lines = split(trimmed(error_output_), '\n');
  fail(how + (lines.back().empty() ? "" : ": " + lines.back()));
}

std::string ChildProcess::how_it_ended() {
  if (!ends_within(kFarewell)) return "program closed its standard input or output";
  siginfo_t end{};
  ::waitid(P_PID, static_cast<id_t>(process_), &end, WEXITED | WNOWAIT);
  if (end.si_code == CLD_EXITED)
    return "program ended with exit code " + std::to_string(end.si_status);
  return formatted("program was killed by signal {} ({})", end.si_status,
                   ::sigdescr_np(end.si_status));
}

bool ChildProcess::ends_within(int milliseconds) const {
  pollfd event{process_handle_.number(), POLLIN, 0};
  return ::poll(&event, 1, milliseconds) > 0;
}

}  // namespace montecarta::experiments
