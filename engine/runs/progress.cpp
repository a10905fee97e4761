// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/progress.hpp"

#include "engine/runs/monte_carlo.hpp"
#include "engine/wrapped_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <unistd.h>

namespace montecarta::engine {
namespace {

constexpr double kBarInterval = 0.1;     // [s]
constexpr double kLeastInterval = 60.0;  // [s] between plain lines
constexpr double kPlainGrowth = 0.02;    // yields a few hundred lines in a night

bool is_smart_terminal(std::FILE* out) {
  const char* kind = std::getenv("TERM");
  return isatty(fileno(out)) == 1 && (kind == nullptr || std::string_view(kind) != "dumb");
}

constexpr std::size_t kWidestBar = 40;
constexpr std::size_t kNarrowestBar = 10;

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

std::string rate_in_words(double per_second) {
  if (per_second >= 0.1) return print("%.3g/s", per_second);
  return print("%.3g/h", per_second * 3600.0);
}

std::string bar(double filled, std::size_t width) {
  const auto full = static_cast<std::size_t>(filled * static_cast<double>(width));
  return '[' + std::string(full, '#') + std::string(width - full, '.') + ']';
}

}  // namespace

void RunCounts::add(RunStatus status) {
  ++(status == RunStatus::complete  ? complete
     : status == RunStatus::failed  ? failed
     : status == RunStatus::missing ? missing
                                    : spared);
}

RunCounts& RunCounts::operator+=(const RunCounts& other) {
  complete += other.complete, failed += other.failed;
  missing += other.missing, spared += other.spared;
  return *this;
}

Progress::Form Progress::form_of(ProgressStyle style, std::FILE* out) {
  if (style == ProgressStyle::none) return Form::none;
  return style == ProgressStyle::automatic && is_smart_terminal(out) ? Form::bar : Form::plain;
}

Progress::Progress(ProgressStyle style, const RunCounts& at_start, std::FILE* out)
    : form_(form_of(style, out)), at_start_(at_start), out_(out) {}

void Progress::run_ended(RunStatus status) {
  (status == RunStatus::failed ? failed_ : complete_).fetch_add(1, std::memory_order_relaxed);
}

void Progress::runs_spared(std::uint64_t runs) {
  spared_.fetch_add(runs, std::memory_order_relaxed);
}

RunCounts Progress::counts() const {
  RunCounts counts = at_start_;
  counts.complete += complete_.load(std::memory_order_relaxed);
  counts.failed += failed_.load(std::memory_order_relaxed);
  counts.spared += spared_.load(std::memory_order_relaxed);
  counts.missing = at_start_.total() + at_start_.spared - counts.ended() - counts.spared;
  return counts;
}

void Progress::show() {
  const double now = stopwatch_.seconds();
  if (form_ == Form::bar && now - last_shown_ >= kBarInterval) show_bar(now);
  if (form_ == Form::plain && now - last_shown_ >= plain_interval(now)) show_plain(now);
}

void Progress::finish() {
  if (form_ != Form::bar) return;
  show_bar(stopwatch_.seconds());
  std::fputc('\n', out_);
}

void Progress::show_bar(double now) {
  last_shown_ = now;
  // The last column stays empty, because some terminals wrap when it is written. ESC [ K clears the
  // rest of the line.
  const std::size_t width = terminal_width(fileno(out_)).value_or(80) - 1;
  const std::string line = progress_bar(counts(), at_start_.ended(), now, width);
  std::fprintf(out_, "\r%s\x1b[K", line.c_str());
  std::fflush(out_);
}

void Progress::show_plain(double now) {
  last_shown_ = now;
  const RunCounts current = counts();
  std::fprintf(out_, "%3d %%  %s\n", static_cast<int>(100.0 * share(current)),
               progress_words(current, at_start_.ended(), now).c_str());
  std::fflush(out_);
}

double plain_interval(double seconds) { return std::max(kLeastInterval, kPlainGrowth * seconds); }

std::string duration_in_words(double seconds) {
  const double whole = std::ceil(seconds);
  if (whole < 60.0) return print("%.0f s", whole);
  const auto in_60ths = [](double fine) {
    return print("%.0f:%02.0f", std::floor(fine / 60.0), std::fmod(fine, 60.0));
  };
  if (whole < 3600.0) return in_60ths(whole) + " min";
  if (whole < 48.0 * 3600.0) return in_60ths(std::ceil(whole / 60.0)) + " h";
  return print("%.1f d", whole / 86400.0);
}

std::string progress_words(const RunCounts& counts, std::uint64_t earlier, double seconds) {
  std::string words =
      std::to_string(counts.ended()) + '/' + std::to_string(counts.total()) + " runs";
  if (counts.failed > 0) words += ", " + std::to_string(counts.failed) + " failed";
  const std::uint64_t here = counts.ended() - earlier;
  if (here == 0 || !(seconds > 0.0)) return words;
  const double rate = static_cast<double>(here) / seconds;
  words += ", " + rate_in_words(rate);
  if (counts.missing == 0) return words + " in " + duration_in_words(seconds);
  return words + ", " + duration_in_words(static_cast<double>(counts.missing) / rate) + " left";
}

std::string progress_bar(const RunCounts& counts, std::uint64_t earlier, double seconds,
                         std::size_t width) {
  const double filled = share(counts);
  // Rounded down, so that 100 % means that no run is left.
  std::string line =
      print("%3.0f %%  ", std::floor(100.0 * filled)) + progress_words(counts, earlier, seconds);
  const std::size_t room = width > line.size() + 3 ? width - line.size() - 3 : 0;
  if (room >= kNarrowestBar) line = bar(filled, std::min(room, kWidestBar)) + ' ' + line;
  return line.substr(0, width);
}

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kInterval = std::chrono::milliseconds(50);
constexpr double kLongestBudget = 1e9;  // [s], 31 years; more would overflow the clock

std::optional<Clock::time_point> deadline_after(std::optional<double> seconds) {
  if (!seconds) return std::nullopt;
  const std::chrono::duration<double> budget(std::min(*seconds, kLongestBudget));
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(budget);
}

}  // namespace

Watch::Watch(const Orders& orders, StopRequest& stop, Progress& progress)
    : interruption_(orders.interruption),
      deadline_(deadline_after(orders.time_budget)),
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
    wake_.wait_for(lock, kInterval, [this] { return over_; });
  }
}

/// Reports a signal at once, because closing the file may take seconds.
void Watch::acknowledge_signal() const {
  if (interruption_.signal() == 0 || stop_.is_set()) return;
  std::fputs("\nmontecarta: stopping; finished runs are kept", stderr);
  std::fputs(runs_under_scheduler() ? "\n" : " (a second signal stops at once)\n", stderr);
}

void Watch::look() {
  acknowledge_signal();
  if (interruption_.signal() == SIGINT) stop_.make(StopReason::sigint);
  if (interruption_.signal() == SIGTERM) stop_.make(StopReason::sigterm);
  if (deadline_ && Clock::now() >= *deadline_) stop_.make(StopReason::time_budget);
  progress_.show();
}

}  // namespace montecarta::engine
