// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace montecarta::experiments {

using TableRow = std::vector<std::string>;

/// Rows with their columns below each other, two spaces between, each line indented by `indent`.
std::string aligned(const std::vector<TableRow>& rows, std::size_t indent = 2);

/// "3.8 MB", "12 kB", "17 B": powers of 1000, two digits or more.
std::string bytes_text(double bytes);
/// "1 h 05 min", "3 min 20 s", "4.2 s".
std::string duration_text(double seconds);

}  // namespace montecarta::experiments
