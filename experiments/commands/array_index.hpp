// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace montecarta::experiments {

/// Replaces "auto" in "auto/N" by the index, from 0, that the scheduler's array gives this task;
/// any other text remains. Throws StudyError if no scheduler gives one, if two disagree, or if the
/// array is not one of N tasks.
std::string with_array_index(const std::string& shard);

}  // namespace montecarta::experiments
