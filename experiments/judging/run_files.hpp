// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Estimates of one estimator.
struct EstimatorFiles {
  std::string cell;                           ///< label
  std::vector<std::filesystem::path> of_run;  ///< one for each run of JudgedFiles
};

/// Which files belong together.
struct JudgedFiles {
  std::vector<std::uint64_t> runs;           ///< one after the other, increasing
  std::vector<std::filesystem::path> truth;  ///< {run}
  std::vector<EstimatorFiles> cells;         ///< by label
};

/// How files are paired, for --help.
std::string pairing_rule();

/// Pairs estimates with truths by that rule. `truths` are files, or folders that `export` made (or
/// their folder truth/). `cell` labels all estimates. Throws StudyError where a run is there twice
/// or not at all.
JudgedFiles pair_files(const std::vector<std::string>& estimates,
                       const std::vector<std::string>& truths,
                       const std::optional<std::string>& cell);

}  // namespace montecarta::experiments
