// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::engine {

/// Number of columns of the terminal `descriptor`; nullopt if it is no terminal.
std::optional<std::size_t> terminal_width(int descriptor);

/// Number of columns of the terminal `descriptor` (1: standard output). If it is no terminal,
/// $COLUMNS or else 80. At least 40.
std::size_t output_width(int descriptor = 1);

/// Breaks `text` between words so that no line is longer than `width` characters, unless it is a
/// single word. A number and its " %" are one word. Each line of `text` is a paragraph: it keeps
/// its leading spaces, and its further lines are indented by `hang` more. A line that fits is not
/// changed. Every line ends in a line break.
std::string wrapped(std::string_view text, std::size_t width, std::size_t hang = 0);

/// Names with their descriptions beside them, wrapped to the width of the output. The description
/// of a name with more than `widest` characters begins on the next line.
std::string listing(const std::vector<std::pair<std::string, std::string>>& items,
                    std::size_t indent = 2, std::size_t widest = output_width() * 2 / 5);

/// `text` up to its first full stop before a capital letter, without the stop.
std::string first_sentence(const std::string& text);

}  // namespace montecarta::engine
