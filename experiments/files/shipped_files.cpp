// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/shipped_files.hpp"

#include <array>
#include <set>
#include <system_error>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

std::array<fs::path, 3> shipped_roots() {
  std::error_code none;
  const fs::path executable = fs::read_symlink("/proc/self/exe", none);
  return {executable.parent_path().parent_path() / "share" / "montecarta", MONTECARTA_INSTALLED_DIR,
          MONTECARTA_SHIPPED_DIR};
}

}  // namespace

std::optional<fs::path> shipped_file(const std::string& folder, const std::string& name) {
  for (const fs::path& root : shipped_roots()) {
    std::error_code none;
    if (fs::is_regular_file(root / folder / name, none)) return root / folder / name;
  }
  return std::nullopt;
}

std::vector<std::string> shipped_names(const std::string& folder, const std::string& ending) {
  std::set<std::string> names;
  for (const fs::path& root : shipped_roots()) {
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(root / folder, none)) {
      if (entry.path().extension() == ending) names.insert(entry.path().stem().string());
    }
  }
  return {names.begin(), names.end()};
}

}  // namespace montecarta::experiments
