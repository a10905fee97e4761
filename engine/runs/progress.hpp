// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"
#include "engine/records/result_file.hpp"
#include "engine/runs/interruption.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace montecarta::engine {

class Stopwatch {
 public:
  /// Wall time since construction [s].
  double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
};

/// Numbers of runs in each state. A run is counted once for every cell.
struct RunCounts {
  std::uint64_t complete = 0, failed = 0, missing = 0, spared = 0;

  std::uint64_t ended() const { return complete + failed; }
  /// Number of runs that are needed.
  std::uint64_t total() const { return ended() + missing; }
  void add(RunStatus status);
  RunCounts& operator+=(const RunCounts& other);
};

/// Seconds in words of at most 8 characters: "12 s", "3:05 min", "12:40 h", "3.4 d".
std::string duration_in_words(double seconds);

/// "1350/3000 runs, 2 failed, 85.2/s, 19 s left" after `seconds` of this session, before which
/// `earlier` runs had ended.
std::string progress_words(const RunCounts& counts, std::uint64_t earlier, double seconds);
/// A bar, the percentage and the words, with at most `width` characters. If they do not fit, the
/// bar is left out first.
std::string progress_bar(const RunCounts& counts, std::uint64_t earlier, double seconds,
                         std::size_t width);

enum class ProgressStyle { automatic, plain, none };

/// Time between two plain lines, `seconds` after the start [s]: at first a minute, later more.
double plain_interval(double seconds);

/// Shows the progress of a study: on a terminal as one line that is redrawn at most ten times a
/// second, elsewhere as a plain line every plain_interval(). Workers only increment counters;
/// another thread shows them.
class Progress {
 public:
  /// `out` is standard error except in tests.
  Progress(ProgressStyle style, const RunCounts& at_start, std::FILE* out = stderr);

  /// Counts a run that a worker has stored. Thread-safe without a lock.
  void run_ended(RunStatus status);
  /// Counts `runs` runs that will not be made.
  void runs_spared(std::uint64_t runs);
  RunCounts counts() const;
  /// Draws if enough time has passed.
  void show();
  /// Draws the final state and ends the line on a terminal. In a log the command prints the
  /// outcome.
  void finish();

 private:
  enum class Form { bar, plain, none };
  static Form form_of(ProgressStyle style, std::FILE* out);

  void show_bar(double seconds);
  void show_plain(double seconds);

  Form form_;
  RunCounts at_start_;
  std::FILE* out_;
  Stopwatch stopwatch_;
  double last_shown_ = 0.0;  ///< [s] on the stopwatch
  std::atomic<std::uint64_t> complete_{0};
  std::atomic<std::uint64_t> failed_{0};
  std::atomic<std::uint64_t> spared_{0};
};

/// A thread that checks twenty times a second for signals and for the end of the time budget,
/// requests the workers to stop if there is one, and shows progress. So the workers need neither
/// clock nor terminal.
class Watch {
 public:
  /// Conditions that end a study early.
  struct Orders {
    const Interruption& interruption;
    std::optional<double> time_budget;  ///< [s] from the construction of the watch
  };

  /// All arguments must outlive the watch.
  Watch(const Orders& orders, StopRequest& stop, Progress& progress);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  void keep_watch();
  void look();
  void acknowledge_signal() const;

  const Interruption& interruption_;
  std::optional<std::chrono::steady_clock::time_point> deadline_;
  StopRequest& stop_;
  Progress& progress_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace montecarta::engine
