// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <string>

namespace montecarta::engine {

/// A number for reading: `digits` significant digits, "-" for NaN. No exponent up to a million.
std::string readable(double value, int digits = 3);

/// A number for reading like readable(), but in powers of ten from ten thousand on, "2.73e5".
std::string compact(double value);

/// A mean with its standard error, "3.58 +- 0.10", both to the second significant digit of the
/// error. "-" for NaN; without error if there is one run.
std::string with_error(double mean, double standard_error);

/// A mean with its error like with_error(), but with a fixed number of decimals.
std::string with_error_to(int decimals, double mean, double standard_error);

/// A time to a tenth of a second, "4.2 s".
std::string fixed_seconds(double time);

/// The shortest text that reads back as the same number; "nan", "inf".
std::string exact_text(double value);

/// A share as "94.6 %".
std::string percent(double share);

/// A level as text, for instance "95 %" or "99.9 %".
std::string level_text(double level);

}  // namespace montecarta::engine
