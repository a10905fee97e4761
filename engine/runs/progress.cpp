// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/progress.hpp"

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <sys/ioctl.h>
#include <unistd.h>

namespace montecarta::engine {
namespace {

constexpr double kBarInterval = 0.1;    // [s]
constexpr double kPlainInterval = 5.0;  // [s]
// A line at least every fiftieth of the time gone by: a night on a cluster gives some hundred
// lines.
constexpr double kPlainGrowth = 0.02;

std::size_t terminal_width(std::FILE* out) {
  winsize size{};
  if (ioctl(fileno(out), TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

bool is_smart_terminal(std::FILE* out) {
  const char* kind = std::getenv("TERM");
  return isatty(fileno(out)) == 1 && (kind == nullptr || std::string_view(kind) != "dumb");
}

std::uint64_t tenths(const RunCounts& counts) {
  return counts.total == 0 ? 10 : 10 * counts.ended() / counts.total;
}

}  // namespace

Progress::Form Progress::form_of(ProgressStyle style, std::FILE* out) {
  if (style == ProgressStyle::none) return Form::none;
  return style == ProgressStyle::automatic && is_smart_terminal(out) ? Form::bar : Form::plain;
}

Progress::Progress(ProgressStyle style, const RunCounts& at_start, std::FILE* out)
    : form_(form_of(style, out)), at_start_(at_start), out_(out), last_tenth_(tenths(at_start)) {}

void Progress::run_ended(RunStatus status) {
  (status == RunStatus::failed ? failed_ : done_).fetch_add(1, std::memory_order_relaxed);
}

void Progress::runs_spared(std::uint64_t runs) {
  spared_.fetch_add(runs, std::memory_order_relaxed);
}

RunCounts Progress::counts() const {
  RunCounts counts = at_start_;
  counts.done += done_.load(std::memory_order_relaxed);
  counts.failed += failed_.load(std::memory_order_relaxed);
  counts.total -= spared_.load(std::memory_order_relaxed);
  return counts;
}

double Progress::seconds() const {
  return std::chrono::duration<double>(Clock::now() - begin_).count();
}

void Progress::show() {
  const double now = seconds();
  if (form_ == Form::bar && now - last_shown_ >= kBarInterval) show_bar(now);
  if (form_ != Form::plain) return;
  const double interval = std::max(kPlainInterval, kPlainGrowth * now);
  if (now - last_shown_ >= interval || tenths(counts()) > last_tenth_) show_plain(now);
}

void Progress::finish() {
  if (form_ == Form::plain) show_plain(seconds());
  if (form_ != Form::bar) return;
  show_bar(seconds());
  std::fputc('\n', out_);
}

void Progress::show_bar(double now) {
  last_shown_ = now;
  // One column stays free: some terminals wrap when the last one is written. ESC [ K clears the
  // rest.
  const std::string line = progress_bar(counts(), now, terminal_width(out_) - 1);
  std::fprintf(out_, "\r%s\x1b[K", line.c_str());
  std::fflush(out_);
}

void Progress::show_plain(double now) {
  last_shown_ = now;
  const RunCounts current = counts();
  last_tenth_ = tenths(current);
  const double percent = current.total == 0 ? 100.0
                                            : 100.0 * static_cast<double>(current.ended()) /
                                                  static_cast<double>(current.total);
  std::fprintf(out_, "%3d %%  %s\n", static_cast<int>(percent),
               progress_words(current, now).c_str());
  std::fflush(out_);
}

}  // namespace montecarta::engine
