// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace montecarta {

/// State of one run of one cell; the numbers are those of the file's `status`.
enum class RunStatus : std::uint8_t { missing = 0, complete = 1, failed = 2 };

}  // namespace montecarta
