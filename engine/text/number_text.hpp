// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <string>

namespace montecarta::engine {

/// Text of a number for readers: `digits` significant digits, "-" for NaN. It has no exponent up to
/// a million.
std::string readable(double value, int digits = 3);

/// Text of a number like readable(), but in powers of ten from ten thousand on, "2.73e5".
std::string compact(double value);

/// Text of a mean with its standard error, "3.58 +- 0.10", both to the second significant digit of
/// the error. "-" for NaN; without error if there is one run.
std::string with_error(double mean, double standard_error);

/// Text of a mean like with_error(), but with a fixed number of decimals.
std::string with_error_to(int decimals, double mean, double standard_error);

/// Text of a time [s] to a tenth of a second, "4.2 s".
std::string fixed_seconds(double time);

/// Text of a time [s], "12.4 s"; of the time of a clock, whose digits count, to a tenth of a
/// second, "1403636583.1 s".
std::string clock_text(double time);

/// A duration in at most 8 characters, rounded up below two days: "4.2 s", "12 s", "3:05 min",
/// "12:40 h", "3.4 d".
std::string duration_text(double seconds);

/// The shortest text that reads back as the same number; "nan", "inf".
std::string exact_text(double value);

/// Text of a share, "94.6 %".
std::string percent(double share);

/// Text of a level, for instance "95 %" or "99.9 %".
std::string level_text(double level);

}  // namespace montecarta::engine
