// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"

#include <cstddef>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <sys/types.h>

namespace montecarta::experiments {

/// A process beside ours that outlives us by a moment: when we are gone, killed perhaps, it kills
/// the process groups that are still guarded. It listens to a socket whose other end nobody but we
/// hold, so it cannot miss our end. (A parent-death signal would follow the thread that started a
/// program.) Any number of threads may use it.
class OrphanGuard {
 public:
  /// The one of this process, started by the first call.
  static OrphanGuard& instance();
  OrphanGuard(const OrphanGuard&) = delete;
  OrphanGuard& operator=(const OrphanGuard&) = delete;

  void guard(pid_t group) const { tell(group); }
  /// To be called before the group's leader is waited for: its number may be another's afterwards.
  void release(pid_t group) const { tell(-group); }

 private:
  OrphanGuard();
  ~OrphanGuard() = default;  // the socket is closed when the process ends
  void tell(pid_t signed_group) const;

  int line_ = -1;  ///< -1: the system has no process left to give, and nothing is guarded
};

/// What went wrong with a program outside of ours, worded as the reason of a failed run.
class ProgramError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The file that `program` names, looked for in $PATH where it holds no '/'. Throws StudyError,
/// worded "problem (why): remedy", where there is none that may be run.
std::filesystem::path find_program(const std::string& program);

/// How long to wait for an answer.
struct TimeLimit {
  double seconds = 30.0;           ///< of wall time
  const StopFlag* stop = nullptr;  ///< ends the wait early
};

/// A file descriptor that is closed with its owner and inherited by nobody.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.number_) { other.number_ = -1; }
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor() { close(); }
  void close();
  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }

 private:
  int number_;
};

/// A program that runs beside ours and exchanges lines with it over pipes: no shell, no inherited
/// descriptor, the signals' defaults, a process group of its own, so that Ctrl-C in a terminal is
/// ours alone. What it says on standard error is read and the end of it kept. For one thread.
class ChildProcess {
 public:
  /// The most bytes that one line of an answer may have.
  static constexpr std::size_t kLongestLine = std::size_t{4} << 20;

  /// Starts words[0] with the others as arguments. Throws RunError where that fails.
  explicit ChildProcess(std::span<const std::string> words);
  /// Closes the program's standard input and gives it a moment to end, unless an exchange has
  /// failed; then kills it and all of its process group. Leaves no zombie.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Says `line`, which holds no new line, and returns the next line that the program says, valid
  /// until the next exchange. Throws ProgramError where it ends, says nothing in time or too much,
  /// or where the wait is stopped; no exchange is possible afterwards.
  std::string_view exchange(std::string_view line, const TimeLimit& time_limit);

 private:
  void start(std::span<const std::string> words, int input, int output, int error);
  bool has_line() const { return incoming_.find('\n') != std::string::npos; }
  void send();
  void receive();
  void listen();
  void wait_for_events(int milliseconds);
  [[noreturn]] void fail(const std::string& reason);
  [[noreturn]] void fail_ended();
  std::string how_it_ended();
  bool ends_within(int milliseconds) const;

  pid_t process_ = -1;
  Descriptor process_handle_;          ///< readable when the process has ended
  Descriptor input_, output_, error_;  ///< our ends
  std::string outgoing_;
  std::size_t sent_ = 0;
  std::string incoming_;
  std::size_t answered_ = 0;  ///< of incoming_: the answer that was returned last
  bool at_end_ = false;       ///< it has closed its standard output, or input
  bool failed_ = false;
  std::string error_output_;  ///< the end of its standard error
};

}  // namespace montecarta::experiments
