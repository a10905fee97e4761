// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace montecarta::experiments {

/// Runs [first, last) of a study.
struct RunRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

/// "A:B", half open; A or B may be left out. Throws StudyError unless 0 <= A < B <= runs.
RunRange parse_run_range(const std::string& text, std::uint64_t runs);
/// "I/N": the I-th (from 0) of N nearly equal ranges that follow each other. Throws StudyError
/// unless I < N <= runs.
RunRange parse_shard(const std::string& text, std::uint64_t runs);

}  // namespace montecarta::experiments
