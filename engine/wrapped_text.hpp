// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace montecarta::engine {

/// Columns of the terminal that `descriptor` is; nullopt if it is none.
std::optional<std::size_t> terminal_width(int descriptor);

/// Columns of the terminal that `descriptor` is (1: standard output). If it is none, $COLUMNS, else
/// 80. At least 40.
std::size_t output_width(int descriptor = 1);

/// `text` broken between words so that no line has more than `width` characters, unless one word
/// does. Each line of `text` is a paragraph: its leading spaces are kept, its further lines are
/// indented by `hang` more. One that fits stays as it is. Every line ends in a line break.
std::string wrapped(std::string_view text, std::size_t width, std::size_t hang = 0);

/// `text` up to its first full stop before a capital letter, without the stop.
std::string first_sentence(const std::string& text);

}  // namespace montecarta::engine
