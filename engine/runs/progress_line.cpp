// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/progress_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace montecarta::engine {
namespace {

constexpr std::size_t kWidestBar = 40;
constexpr std::size_t kNarrowestBar = 10;

template <class... Values>
std::string print(const char* format, Values... values) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

double share(const RunCounts& counts) {
  if (counts.total == 0) return 1.0;
  return static_cast<double>(counts.ended()) / static_cast<double>(counts.total);
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

std::string progress_words(const RunCounts& counts, double seconds) {
  std::string words = std::to_string(counts.ended()) + '/' + std::to_string(counts.total) + " runs";
  if (counts.failed > 0) words += ", " + std::to_string(counts.failed) + " failed";
  const std::uint64_t here = counts.ended() - counts.earlier;
  if (here == 0 || !(seconds > 0.0)) return words;
  const double rate = static_cast<double>(here) / seconds;
  words += ", " + rate_in_words(rate);
  const std::uint64_t left = counts.total - counts.ended();
  if (left == 0) return words + " in " + duration_in_words(seconds);
  return words + ", " + duration_in_words(static_cast<double>(left) / rate) + " left";
}

std::string progress_bar(const RunCounts& counts, double seconds, std::size_t width) {
  const double filled = share(counts);
  // Rounded down, so that 100 % means that nothing is left.
  std::string line =
      print("%3.0f %%  ", std::floor(100.0 * filled)) + progress_words(counts, seconds);
  const std::size_t room = width > line.size() + 3 ? width - line.size() - 3 : 0;
  if (room >= kNarrowestBar) line = bar(filled, std::min(room, kWidestBar)) + ' ' + line;
  return line.substr(0, width);
}

}  // namespace montecarta::engine
