// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace montecarta::experiments {

/// The number that all of `text` spells, in the C locale; nullopt where it is not one or not
/// finite.
std::optional<double> to_number(std::string_view text);
/// Likewise for whole numbers without sign; nullopt where 64 bits do not hold it.
std::optional<std::uint64_t> to_count(std::string_view text);
/// The shortest text that reads back as exactly `value`.
std::string to_text(double value);

}  // namespace montecarta::experiments
