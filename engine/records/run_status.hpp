// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <cstdint>
#include <span>
#include <string>

namespace montecarta::engine {

/// State of one run of one cell; the numbers are those of the file's `status`. Spared: not made,
/// since the runs before it were enough.
enum class RunStatus : std::uint8_t { missing = 0, complete = 1, failed = 2, spared = 3 };

/// Whether a run of that state has left a record.
inline bool is_stored(RunStatus status) {
  return status == RunStatus::complete || status == RunStatus::failed;
}

/// Throws RunError, beginning with `place`, where a number read from a file is none of these.
void expect_known(std::span<const RunStatus> statuses, const std::string& place);

}  // namespace montecarta::engine
