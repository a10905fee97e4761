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

/// A second process that kills the guarded process groups when this process has ended, for
/// whichever reason. It waits on a socket of which only this process holds the other end, so it
/// cannot miss the end. (A parent-death signal would depend on the thread that started a program
/// instead of the process.) A program runs for a moment before the guard knows it; if this process
/// is killed in that moment, only the end of its input tells the program to end. May be used by any
/// number of threads.
class OrphanGuard {
 public:
  /// The guard of this process, which the first call starts.
  static OrphanGuard& instance();
  OrphanGuard(const OrphanGuard&) = delete;
  OrphanGuard& operator=(const OrphanGuard&) = delete;

  void guard(pid_t group) const { send(group); }
  /// Must be called before the leader of the group is waited for, because its number may belong to
  /// another process afterwards.
  void release(pid_t group) const { send(-group); }

 private:
  OrphanGuard();
  ~OrphanGuard() = default;  // the socket is closed when the process ends
  void send(pid_t signed_group) const;

  int line_ = -1;  ///< -1 if the system could not start a process; then nothing is guarded
};

/// An error of an external program, worded as the reason of a failed run.
class ProgramError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The file that `program` names, searched in $PATH if the name contains no '/'. Throws StudyError,
/// worded "problem (why): remedy", if there is no executable file of that name.
std::filesystem::path find_program(const std::string& program);

/// Limits of the wait for an answer.
struct TimeLimit {
  double seconds = 30.0;           ///< [s] limit of wall time
  const StopFlag* stop = nullptr;  ///< ends the wait early
};

/// A file descriptor that is closed with its owner. Child processes do not inherit it.
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

/// A program that runs beside this one and exchanges lines with it over pipes. It is started
/// without a shell, without inherited descriptors, with default signal handlers, and in a process
/// group of its own, so that Ctrl-C in a terminal reaches only this process. The end of its
/// standard error is kept. For use by one thread.
class ChildProcess {
 public:
  /// Largest length of an answer [byte].
  static constexpr std::size_t kLongestLine = std::size_t{4} << 20;

  /// Starts words[0] with the other words as arguments. Throws RunError if that fails.
  explicit ChildProcess(std::span<const std::string> words);
  /// Closes the program's standard input and, unless an exchange has failed, waits a moment for the
  /// program to end. Then kills it and its process group. Leaves no zombie.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Returns whether the program has answered anything yet.
  bool has_answered() const { return answered_ > 0; }
  /// Sends `line`, which must not contain a line break, and returns the next line of the program's
  /// output, which is valid until the next exchange. Throws ProgramError if the program ends, its
  /// answer is late or too long, or the wait is stopped. After an error no further exchange is
  /// possible.
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
  Descriptor input_, output_, error_;  ///< ends of the pipes in this process
  std::string outgoing_;
  std::size_t sent_ = 0;
  std::string incoming_;
  std::size_t answered_ = 0;  ///< length of the answer in incoming_ that was returned last
  bool at_end_ = false;       ///< whether the program has closed its standard output or input
  bool failed_ = false;
  std::string error_output_;  ///< end of the program's standard error
};

}  // namespace montecarta::experiments
