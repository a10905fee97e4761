// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/study.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The benchmark: every filter in every world, one study for each pair (experiments/BENCHMARK.md).
namespace montecarta::experiments {

/// The frozen worlds and settings that results belong to.
inline constexpr const char* kBenchmarkEdition = "1";

/// Names of the worlds, in alphabetical order, each of which is a shipped study with one cell.
std::vector<std::string> benchmark_worlds();

/// A filter of the benchmark in one setting.
struct BenchmarkFilter {
  std::string label;
  std::string cell;  ///< the value of `cell` in a study file
};

/// The shipped filters of the benchmark, in the order in which they are run.
std::vector<BenchmarkFilter> benchmark_filters();

/// The filter that one value of `cell` describes. Throws StudyError if it describes several.
BenchmarkFilter filter_of_cell(const std::string& cell);

/// The study of one filter in one world. Without `runs` it has as many as the world says. Throws
/// StudyError if there is no such world, or if the world does not suit the filter.
Study benchmark_study(const std::string& world, const std::string& cell,
                      std::optional<std::uint64_t> runs = std::nullopt);

/// Returns whether the world suits the filter.
bool suits(const std::string& world, const std::string& cell);

/// SHA-256 of all that decides the drives of a study and what filters are given and assume: its
/// seed, scenario, belief, association and world. Cells and numbers of runs do not count, so the
/// runs of two studies with the same value can be paired. `resolved_text` is that of the study.
std::string drives_sha256(std::string_view resolved_text);

}  // namespace montecarta::experiments
