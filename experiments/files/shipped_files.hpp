// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// A file that comes with montecarta, e.g. ("worlds", "web_loop.csv"): beside the installed
/// executable
/// (../share/montecarta), else in the source tree this was built from. nullopt where there is none.
std::optional<std::filesystem::path> shipped_file(const std::string& folder,
                                                  const std::string& name);

/// Names without ending of the files of a shipped folder that end so, in alphabetical order.
std::vector<std::string> shipped_names(const std::string& folder, const std::string& ending);

}  // namespace montecarta::experiments
