// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"
#include "engine/wrapped_text.hpp"

#include <cstddef>
#include <string>

namespace montecarta::experiments {

/// Formats names with their descriptions beside them, wrapped to the width of the output. The
/// description of a name with more than `widest` characters begins on the next line.
std::string listing(const TextPairs& items, std::size_t indent = 2,
                    std::size_t widest = output_width() * 2 / 5);

}  // namespace montecarta::experiments
