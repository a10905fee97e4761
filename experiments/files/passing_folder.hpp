// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"
#include "engine/namespaces.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdlib.h>
#include <string>

namespace montecarta::experiments {

/// A folder of its own among temporary files, which is removed in the end.
class PassingFolder {
 public:
  /// Throws RunError if no folder can be made.
  PassingFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "montecarta_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw RunError("{}: cannot be made ({}): set TMPDIR to a folder with room", name,
                     std::strerror(errno));
    }
    path_ = name;
  }
  ~PassingFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  PassingFolder(const PassingFolder&) = delete;
  PassingFolder& operator=(const PassingFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace montecarta::experiments
