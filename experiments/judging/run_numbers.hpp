// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The numbers in a path that name its run: usually one, several e.g. for the tasks and processes
/// of a cluster. Empty if the path has none.
using RunKey = std::vector<std::uint64_t>;

/// The file of one run, and the rest of its path.
struct NumberedFile {
  std::filesystem::path path;
  RunKey run;
  std::vector<std::string> rest;  ///< names of folders and file without the number of the run
  bool is_called_run = false;     ///< the word before the number is "run"
};

/// Text of a key: "3", or "4/0".
std::string to_text(const RunKey& key);

/// Finds the numbers of the runs in the paths of files. Among paths that are alike except for their
/// numbers, the run is the number that varies. If several vary, it is the one named run, seed,
/// trial or the like; else those named task or process; else the last one. If none varies, e.g.
/// because there is one file, all are considered in the same order.
std::vector<NumberedFile> numbered_files(const std::vector<std::filesystem::path>& paths);

}  // namespace montecarta::experiments
