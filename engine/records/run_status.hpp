// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace montecarta {

/// State of one run of one cell; the numbers are those of the file's `status`.
enum class RunStatus : std::uint8_t { missing = 0, complete = 1, failed = 2 };

/// Throws RunError, beginning with `place`, where a number read from a file is none of these.
void expect_known(std::span<const RunStatus> statuses, const std::string& place);

}  // namespace montecarta
