// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace montecarta::engine {

/// A file or folder of the published data, e.g. "victoria_park"; empty where it is not at hand. The
/// data is never committed: it lies in MONTECARTA_DATA, or in shared/data beside the project.
inline std::filesystem::path published_data(const std::string& name) {
  const char* named = std::getenv("MONTECARTA_DATA");
  const std::filesystem::path folder =
      named != nullptr ? named : std::filesystem::path(MONTECARTA_SOURCE_DIR) / "../shared/data";
  return std::filesystem::exists(folder / name) ? folder / name : std::filesystem::path();
}

}  // namespace montecarta::engine
