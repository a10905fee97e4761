// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <type_traits>
#include <utility>

namespace montecarta::engine {

/// The part of a value that formatted() writes: the name of a path, else the value as it is.
template <typename Value>
const Value& written(const Value& value) {
  static_assert(!std::is_floating_point_v<Value>,
                "a number with decimals becomes a text by engine/text/number_text.hpp first");
  return value;
}
inline const std::string& written(const std::filesystem::path& path) { return path.native(); }

/// A text with a {} for each of the values. The compiler counts them.
template <typename... Values>
using FormatOf = fmt::format_string<decltype(written(std::declval<const Values&>()))...>;

/// `text` with its first {} replaced by the first value, its second by the second, and so on:
/// formatted("{}: {} runs are missing", path, 3). A value is a text, a path or a whole number.
template <typename... Values>
std::string formatted(FormatOf<Values...> text, const Values&... values) {
  return fmt::vformat(text, fmt::make_format_args(written(values)...));
}

}  // namespace montecarta::engine
