// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/external/child_process.hpp"

#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

// Talking to a child; it is started in start_child.cpp.

namespace montecarta::experiments {
namespace {

constexpr int kFarewell = 1000;  // [ms] for a program to end when nobody asks it any more
constexpr int kLookUp = 50;      // [ms] between two looks at the stop flag
/// How long a worker looks for an answer before it sleeps: to wake it on an idle core costs more
/// than a scan of a fast filter.
constexpr std::chrono::microseconds kAwake{50};
constexpr std::size_t kErrorOutput = 4096;  // [byte]

/// While one lives, a pipe that nobody reads is an error of write(), no signal to this thread.
class WithoutSigpipe {
 public:
  WithoutSigpipe() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~WithoutSigpipe() {
    if (broken_ && sigismember(&before_, SIGPIPE) == 0) {
      const timespec at_once{};
      while (::sigtimedwait(&pipe_, nullptr, &at_once) < 0 && errno == EINTR) continue;
    }
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  WithoutSigpipe(const WithoutSigpipe&) = delete;
  WithoutSigpipe& operator=(const WithoutSigpipe&) = delete;
  void note_broken() { broken_ = true; }

 private:
  sigset_t pipe_{};
  sigset_t before_{};
  bool broken_ = false;
};

bool is_for_later(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

}  // namespace

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
  ::kill(-process_, SIGKILL);  // before the process is reaped its number is nobody else's
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
  WithoutSigpipe guard;
  const ssize_t n = ::write(input_.number(), outgoing_.data() + sent_, outgoing_.size() - sent_);
  if (n >= 0) {
    sent_ += static_cast<std::size_t>(n);
  } else if (!is_for_later(errno)) {
    guard.note_broken();
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

/// Reads what there is on the program's standard error.
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

/// It said its last line: how it ended, and why, if it told.
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
  return "program was killed by signal " + std::to_string(end.si_status) + " (" +
         ::sigdescr_np(end.si_status) + ")";
}

bool ChildProcess::ends_within(int milliseconds) const {
  pollfd event{process_handle_.number(), POLLIN, 0};
  return ::poll(&event, 1, milliseconds) > 0;
}

}  // namespace montecarta::experiments
