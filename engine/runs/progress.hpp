// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"
#include "engine/records/run_record.hpp"
#include "engine/runs/interruption.hpp"

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
  std::uint64_t complete = 0, failed = 0, missing = 0, not_needed = 0;

  std::uint64_t ended() const { return complete + failed; }
  /// Number of runs that are needed.
  std::uint64_t total() const { return ended() + missing; }
  /// Counts some runs of this status.
  void add(RunStatus status, std::uint64_t runs = 1);
  RunCounts& operator+=(const RunCounts& other);
};

/// A line of progress after `seconds` of this session, before which `earlier` runs had ended: " 45
/// %  1350/3000 runs, 2 failed, 85.2/s, 19 s left".
std::string progress_line(const RunCounts& counts, std::uint64_t earlier, double seconds);
/// Puts a bar before `line`, filled in proportion to the runs that ended; at most `width`
/// characters in all. If there is no room for the bar, it is left out.
std::string with_bar(const std::string& line, const RunCounts& counts, std::size_t width);

enum class ProgressStyle { automatic, plain, none };

/// Time between two plain lines, `seconds` after the start [s]: at first a minute, later more.
double plain_interval(double seconds);

/// Shows the progress of a study: on a terminal as one line that is redrawn at most ten times a
/// second, elsewhere as a plain line every plain_interval(). Workers only count; another thread
/// shows the counts.
class Progress {
 public:
  /// `out` is standard error except in tests.
  Progress(ProgressStyle style, const RunCounts& at_start, std::FILE* out = stderr);

  /// Counts missing runs that now have this status. Thread-safe.
  void runs_ended(RunStatus status, std::uint64_t runs = 1);
  RunCounts counts() const;
  /// Draws if enough time has passed.
  void show();
  /// Draws the final state and ends the line on a terminal. In a log the command prints the
  /// outcome.
  void finish();

 private:
  void draw(double seconds);

  std::FILE* out_;  ///< output; nullptr: nothing is shown
  bool redraws_;    ///< whether one line on a terminal is redrawn
  std::uint64_t earlier_;
  Stopwatch stopwatch_;
  double last_shown_ = 0.0;  ///< [s] time on the stopwatch
  mutable std::mutex mutex_;
  RunCounts counts_;
};

/// A thread that checks twenty times a second for signals and for the end of the time budget,
/// requests the workers to stop if there is one, and shows progress. So the workers need neither
/// clock nor terminal.
class Watch {
 public:
  /// `time_budget` [s] counts from now. The other arguments must outlive the watch.
  Watch(const Interruption& interruption, std::optional<double> time_budget, StopRequest& stop,
        Progress& progress);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  void keep_watch();
  void look();

  const Interruption& interruption_;
  std::optional<double> time_budget_;
  StopRequest& stop_;
  Progress& progress_;
  Stopwatch stopwatch_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace montecarta::engine
