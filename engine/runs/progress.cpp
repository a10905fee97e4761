// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/progress.hpp"

#include "engine/formatted.hpp"
#include "engine/text/number_text.hpp"
#include "engine/text/wrapped_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <unistd.h>

namespace montecarta::engine {
namespace {

bool is_smart_terminal(std::FILE* out) {
  const char* kind = std::getenv("TERM");
  return isatty(fileno(out)) == 1 && (kind == nullptr || std::string_view(kind) != "dumb");
}

template <class... Values>
std::string print(const char* format, Values... values) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

double share(const RunCounts& counts) {
  if (counts.total() == 0) return 1.0;
  return static_cast<double>(counts.ended()) / static_cast<double>(counts.total());
}

}  // namespace

void RunCounts::add(RunStatus status, std::uint64_t runs) {
  (status == RunStatus::complete  ? complete
   : status == RunStatus::failed  ? failed
   : status == RunStatus::missing ? missing
                                  : not_needed) += runs;
}

RunCounts& RunCounts::operator+=(const RunCounts& other) {
  complete += other.complete, failed += other.failed;
  missing += other.missing, not_needed += other.not_needed;
  return *this;
}

std::string progress_line(const RunCounts& counts, std::uint64_t earlier, double seconds) {
  // Rounded down, so that 100 % means that no run is left.
  std::string line =
      formatted("{}{}/{} runs", print("%3.0f %%  ", std::floor(100.0 * share(counts))),
                counts.ended(), counts.total());
  if (counts.failed > 0) line += formatted(", {} failed", counts.failed);
  const std::uint64_t here = counts.ended() - earlier;
  if (here == 0 || !(seconds > 0.0)) return line;
  const double rate = static_cast<double>(here) / seconds;
  line += rate >= 0.1 ? print(", %.3g/s", rate) : print(", %.3g/h", rate * 3600.0);
  if (counts.missing == 0) return formatted("{} in {}", line, duration_text(seconds));
  return formatted("{}, {} left", line, duration_text(static_cast<double>(counts.missing) / rate));
}

std::string with_bar(const std::string& line, const RunCounts& counts, std::size_t width) {
  constexpr std::size_t kWidestBar = 40, kNarrowestBar = 10;
  const std::size_t room = width - std::min(width, line.size() + 3);
  if (room < kNarrowestBar) return line.substr(0, width);
  const std::size_t length = std::min(room, kWidestBar);
  const auto filled = static_cast<std::size_t>(share(counts) * static_cast<double>(length));
  return formatted("[{}{}] {}", std::string(filled, '#'), std::string(length - filled, '.'), line);
}

double plain_interval(double seconds) {
  return std::max(60.0, 0.02 * seconds);  // this makes a few hundred lines in a night
}

Progress::Progress(ProgressStyle style, const RunCounts& at_start, std::FILE* out)
    : out_(style == ProgressStyle::none ? nullptr : out),
      redraws_(style == ProgressStyle::automatic && is_smart_terminal(out)),
      earlier_(at_start.ended()),
      counts_(at_start) {}

void Progress::runs_ended(RunStatus status, std::uint64_t runs) {
  const std::lock_guard lock(mutex_);
  counts_.add(status, runs);
  counts_.missing -= runs;
}

RunCounts Progress::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void Progress::show() {
  const double now = stopwatch_.seconds();
  if (now - last_shown_ >= (redraws_ ? 0.1 : plain_interval(now))) draw(now);
}

void Progress::finish() {
  if (!redraws_) return;
  draw(stopwatch_.seconds());
  std::fputc('\n', out_);
}

void Progress::draw(double seconds) {
  if (out_ == nullptr) return;
  last_shown_ = seconds;
  const RunCounts now = counts();
  const std::string line = progress_line(now, earlier_, seconds);
  if (redraws_) {
    // The last column stays empty, because some terminals wrap when it is written. ESC [ K clears
    // the rest of the line.
    const std::size_t width = terminal_width(fileno(out_)).value_or(80) - 1;
    std::fprintf(out_, "\r%s\x1b[K", with_bar(line, now, width).c_str());
  } else {
    std::fprintf(out_, "%s\n", line.c_str());
  }
  std::fflush(out_);
}

Watch::Watch(const Interruption& interruption, std::optional<double> time_budget, StopRequest& stop,
             Progress& progress)
    : interruption_(interruption),
      time_budget_(time_budget),
      stop_(stop),
      progress_(progress),
      thread_([this] { keep_watch(); }) {}

Watch::~Watch() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  wake_.notify_all();
  thread_.join();
  progress_.finish();
}

void Watch::keep_watch() {
  std::unique_lock lock(mutex_);
  while (!over_) {
    look();
    wake_.wait_for(lock, std::chrono::milliseconds(50), [this] { return over_; });
  }
}

void Watch::look() {
  const int signal = interruption_.signal();
  // Reported at once, because closing the file may take seconds.
  if (signal != 0 && !stop_.is_set()) {
    std::fputs("\nmontecarta: stopping; finished runs are kept", stderr);
    std::fputs(runs_under_scheduler() ? "\n" : " (a second signal stops at once)\n", stderr);
  }
  if (signal != 0) stop_.make(interruption_.reason());
  if (time_budget_ && stopwatch_.seconds() >= *time_budget_) stop_.make(StopReason::time_budget);
  progress_.show();
}

}  // namespace montecarta::engine
