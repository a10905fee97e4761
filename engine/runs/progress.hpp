// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_file.hpp"
#include "engine/runs/progress_line.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>

namespace montecarta::engine {

enum class ProgressStyle { automatic, plain, none };

/// Tells the user how far a study has come: on a terminal one line redrawn at most ten times a
/// second, elsewhere plain lines, at every tenth of the study and every few seconds, more rarely as
/// the study grows long. Workers only add to counters; one other thread shows.
class Progress {
 public:
  /// `out` is standard error but for tests.
  Progress(ProgressStyle style, const RunCounts& at_start, std::FILE* out = stderr);

  /// A worker has stored a run. Thread-safe, no lock.
  void run_ended(RunStatus status);
  /// So many runs will not be made.
  void runs_spared(std::uint64_t runs);
  RunCounts counts() const;
  /// Draws if it is time to.
  void show();
  /// Draws the last state and ends the line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  enum class Form { bar, plain, none };
  static Form form_of(ProgressStyle style, std::FILE* out);

  void show_bar(double seconds);
  void show_plain(double seconds);
  double seconds() const;

  Form form_;
  RunCounts at_start_;
  std::FILE* out_;
  Clock::time_point begin_ = Clock::now();
  double last_shown_ = 0.0;   ///< [s] since begin
  std::uint64_t last_tenth_;  ///< of the study, at the last plain line
  std::atomic<std::uint64_t> done_{0};
  std::atomic<std::uint64_t> failed_{0};
  std::atomic<std::uint64_t> spared_{0};
};

}  // namespace montecarta::engine
