// SPDX-License-Identifier: BSD-3-Clause
#include "engine/text/number_text.hpp"

#include "engine/formatted.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace montecarta::engine {
namespace {

/// Text of a number; one that is rounded to zero has no sign.
std::string printed(const char* format, int precision, double value) {
  std::array<char, 512> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, precision, value);
  std::string text = buffer.data();
  if (text.find_first_not_of("-0.") == std::string::npos) std::erase(text, '-');
  return text;
}

/// Power of ten of the first significant digit: 0 for 3.58, -2 for 0.012.
int magnitude(double value) {
  return value == 0.0 ? 0 : static_cast<int>(std::floor(std::log10(std::abs(value))));
}

}  // namespace

std::string readable(double value, int digits) {
  if (std::isnan(value)) return "-";
  if (!std::isfinite(value) || std::abs(value) >= 1e6) return printed("%.*g", digits, value);
  if (value != 0.0 && std::abs(value) < 1e-4) return printed("%.*g", digits, value);
  return printed("%.*f", std::max(0, digits - 1 - magnitude(value)), value);
}

std::string compact(double value) {
  if (!std::isfinite(value) || std::abs(value) < 1e4) return readable(value);
  const int power = magnitude(value);
  return formatted("{}e{}", printed("%.*f", 2, value / std::pow(10.0, power)), power);
}

std::string with_error(double mean, double standard_error) {
  if (std::isnan(mean) || !std::isfinite(standard_error) || standard_error == 0.0) {
    return readable(mean);
  }
  if (std::abs(mean) >= 1e6)
    return formatted("{} +- {}", readable(mean), readable(standard_error, 2));
  const int decimals = std::clamp(1 - magnitude(standard_error), 0, 12);
  return formatted("{} +- {}", printed("%.*f", decimals, mean),
                   printed("%.*f", decimals, standard_error));
}

std::string with_error_to(int decimals, double mean, double standard_error) {
  if (std::isnan(mean)) return "-";
  std::string text = printed("%.*f", decimals, mean);
  if (std::isnan(standard_error)) return text;
  return formatted("{} +- {}", text, printed("%.*f", decimals, standard_error));
}

std::string fixed_seconds(double time) { return printed("%.*f", 1, time) + " s"; }

std::string clock_text(double time) {
  return std::abs(time) < 1e6 ? readable(time) + " s" : fixed_seconds(time);
}

std::string duration_text(double seconds) {
  const double tenths = std::ceil(10.0 * seconds);
  if (tenths < 100.0) return printed("%.*f s", 1, tenths / 10.0);
  const double whole = std::ceil(seconds);
  if (whole < 60.0) return printed("%.*f s", 0, whole);
  const auto in_60ths = [](double fine) {
    const double rest = std::fmod(fine, 60.0);
    return printed("%.*f:", 0, std::floor(fine / 60.0)) + (rest < 10.0 ? "0" : "") +
           printed("%.*f", 0, rest);
  };
  if (whole < 3600.0) return in_60ths(whole) + " min";
  if (whole < 48.0 * 3600.0) return in_60ths(std::ceil(whole / 60.0)) + " h";
  return printed("%.*f d", 1, whole / 86400.0);
}

std::string exact_text(double value) {
  if (std::isnan(value)) return "nan";
  std::array<char, 64> text{};
  // A whole number is written without exponent: 100000, not 1e+05.
  const bool is_count = std::abs(value) < 1e15 && value == std::trunc(value);
  const auto end = is_count
                       ? std::to_chars(text.begin(), text.end(), value, std::chars_format::fixed)
                       : std::to_chars(text.begin(), text.end(), value);
  return {text.data(), end.ptr};
}

std::string percent(double share) {
  return std::isnan(share) ? "-" : printed("%.*f", 1, 100.0 * share) + " %";
}

std::string level_text(double level) {
  // 100 * 0.95 is not 95 in binary: six digits are more than anyone writes.
  return printed("%.*g", 6, 100.0 * level) + " %";
}

}  // namespace montecarta::engine
