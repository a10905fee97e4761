// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/progress.hpp"

#include "tests/doubles/matchers.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <memory>
#include <poll.h>
#include <string>
#include <sys/ioctl.h>
#include <thread>
#include <unistd.h>

namespace montecarta::engine {
namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

std::string text_of(std::FILE* file) {
  std::rewind(file);
  std::array<char, 4096> text{};
  return {text.data(), std::fread(text.data(), 1, text.size(), file)};
}

/// The progress that a study of `total` runs, which end one by one, writes to a file.
std::string shown_of(ProgressStyle style, std::uint64_t total) {
  const File file(std::tmpfile(), std::fclose);
  Progress progress(style, {.missing = total}, file.get());
  for (std::uint64_t run = 0; run < total; ++run) {
    progress.runs_ended(run == 0 ? RunStatus::failed : RunStatus::complete);
    progress.show();
  }
  progress.finish();
  return text_of(file.get());
}

TEST(Progress, WritesAtMostOnePlainLineAMinuteOrNone) {
  EXPECT_EQ(shown_of(ProgressStyle::automatic, 100), "") << "all within the first minute";
  EXPECT_EQ(plain_interval(0.0), 60.0);
  EXPECT_EQ(plain_interval(36'000.0), 720.0) << "more rarely in a long study";
  EXPECT_EQ(shown_of(ProgressStyle::none, 100), "");
}

TEST(Progress, CountsFromManyThreads) {
  Progress progress(ProgressStyle::none, {.complete = 5, .failed = 1, .missing = 4000});
  const auto end_runs = [&] {
    for (int i = 0; i < 1000; ++i) progress.runs_ended(RunStatus::complete);
    for (int i = 0; i < 1000; ++i) progress.runs_ended(RunStatus::failed);
  };
  std::thread other(end_runs);
  end_runs();
  other.join();
  EXPECT_EQ(progress.counts().complete, 2005U);
  EXPECT_EQ(progress.counts().failed, 2001U);
}

/// A terminal 30 characters wide, as the program sees one, and the other end of its line. A bare
/// container has none to give: then `inside` is empty.
class Terminal {
 public:
  Terminal() : outside_(posix_openpt(O_RDWR | O_NOCTTY)) {
    if (outside_ < 0 || grantpt(outside_) != 0 || unlockpt(outside_) != 0) return;
    const char* name = ptsname(outside_);
    if (name != nullptr) inside.reset(std::fopen(name, "w"));
    const winsize size{.ws_row = 24, .ws_col = 30, .ws_xpixel = 0, .ws_ypixel = 0};
    ioctl(outside_, TIOCSWINSZ, &size);
  }
  ~Terminal() {
    if (outside_ >= 0) close(outside_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  std::string seen() const {
    std::string all;
    pollfd waiting{.fd = outside_, .events = POLLIN, .revents = 0};
    while (!all.ends_with('\n') && poll(&waiting, 1, 5000) == 1) {
      std::array<char, 4096> text{};
      const ssize_t length = read(outside_, text.data(), text.size());
      if (length <= 0) break;
      all.append(text.data(), static_cast<std::size_t>(length));
    }
    return all;
  }
  File inside{nullptr, std::fclose};

 private:
  int outside_;
};

TEST(Progress, RedrawsOneLineOnATerminalWithinItsWidth) {
  ::setenv("TERM", "xterm", 1);
  const Terminal terminal;
  if (!terminal.inside) GTEST_SKIP() << "this machine gives no pseudo terminal";
  const auto began = std::chrono::steady_clock::now();
  Progress progress(ProgressStyle::automatic, {.missing = 20}, terminal.inside.get());
  for (int i = 0; i < 20; ++i) {
    progress.runs_ended(RunStatus::complete);
    progress.show();  // not drawn within a tenth of a second of the last time
  }
  progress.finish();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  const std::string seen = terminal.seen();
  EXPECT_THAT(seen, StartsWith("\r"));
  EXPECT_THAT(seen, HasSubstr("\r100 %  20/20 runs"));
  EXPECT_THAT(seen, EndsWith("\x1b[K\r\n"));
  EXPECT_EQ(std::ranges::count(seen, '\n'), 1) << seen;
  EXPECT_LE(static_cast<double>(std::ranges::count(seen, '\x1b')), 1.0 + took.count() / 0.1);
  for (std::size_t at = 0; (at = seen.find('\x1b', at + 1)) != std::string::npos;) {
    EXPECT_EQ(at - seen.rfind('\r', at), 1U + 29U) << "one column stays free: " << seen;
  }
}

TEST(ProgressLine, TellsCountsRateAndTime) {
  EXPECT_EQ(progress_line({.complete = 148, .failed = 2, .missing = 150}, 50, 10.0),
            " 50 %  150/300 runs, 2 failed, 10/s, 15 s left");
  EXPECT_EQ(progress_line({.complete = 50, .missing = 250}, 50, 10.0), " 16 %  50/300 runs");
  EXPECT_EQ(progress_line({.complete = 300}, 0, 10.0), "100 %  300/300 runs, 30/s in 10 s");
  EXPECT_EQ(progress_line({.complete = 1, .missing = 1}, 0, 600.0),
            " 50 %  1/2 runs, 6/h, 10:00 min left");
}

TEST(ProgressLine, HasABarWhereItFitsAndNeverExceedsTheWidth) {
  const auto line_of = [](const RunCounts& counts, double seconds, std::size_t width) {
    return with_bar(progress_line(counts, 0, seconds), counts, width);
  };
  const RunCounts half{.complete = 150, .missing = 150};
  EXPECT_EQ(line_of(half, 10.0, 200),
            "[####################....................]  50 %  150/300 runs, 15/s, 10 s left");
  EXPECT_EQ(line_of(half, 10.0, 40), " 50 %  150/300 runs, 15/s, 10 s left");
  for (std::size_t width = 0; width < 120; ++width)
    EXPECT_LE(line_of({.complete = 123, .failed = 7, .missing = 870}, 3.0, width).size(), width);
  EXPECT_EQ(line_of({.complete = 9999, .missing = 1}, 1.0, 12), " 99 %  9999/");
}

}  // namespace
}  // namespace montecarta::engine
