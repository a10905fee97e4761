// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace montecarta::experiments {

/// Replaces "auto" in "auto/N" by the index, from 0, that the scheduler's array gives this task;
/// any other text remains. Throws StudyError if no scheduler gives one, if two disagree, if the
/// index is none of N, or if the scheduler tells another last number of the array.
std::string with_array_index(const std::string& shard);

}  // namespace montecarta::experiments
