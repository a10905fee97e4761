// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/run_range.hpp"

#include "engine/errors.hpp"
#include "experiments/text/numbers.hpp"
#include "experiments/text/words.hpp"

namespace montecarta::experiments {

RunRange parse_run_range(const std::string& text, std::uint64_t runs) {
  const auto parts = split(text, ':');
  const auto first = parts.front().empty() ? 0 : to_count(parts.front());
  const auto last = parts.back().empty() ? runs : to_count(parts.back());
  if (parts.size() == 2 && first && last && *first < *last && *last <= runs) return {*first, *last};
  throw StudyError("--runs " + text +
                   ": no range of this study's runs (A:B means A, ..., B-1 out of 0 to " +
                   std::to_string(runs - 1) + "): give e.g. --runs 0:" + std::to_string(runs));
}

RunRange parse_shard(const std::string& text, std::uint64_t runs) {
  const auto parts = split(text, '/');
  const auto index = to_count(parts.front());
  const auto count = to_count(parts.back());
  if (parts.size() == 2 && index && count && *index < *count && *count <= runs) {
    return {*index * runs / *count, (*index + 1) * runs / *count};
  }
  throw StudyError("--shard " + text +
                   ": no shard of this study (I/N means part I, from 0 to N-1, of N; at most " +
                   std::to_string(runs) + " parts, one a run): give e.g. --shard 0/" +
                   std::to_string(runs < 4 ? runs : 4));
}

}  // namespace montecarta::experiments
