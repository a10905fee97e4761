// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/worlds/world_file.hpp"

#include "engine/errors.hpp"
#include "experiments/files/shipped_files.hpp"
#include "experiments/text/words.hpp"

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

bool is_path(const std::string& name) {
  return name.find('/') != std::string::npos || name.ends_with(".csv") || name.ends_with(".mat");
}

/// Where a path that a study gives leads, or the path itself where there is nothing.
fs::path resolved_path(const std::string& name, const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) {
    if (fs::exists(folder / name)) return folder / name;
  }
  return name;
}

}  // namespace

World read_world_file(const fs::path& path) {
  if (!fs::exists(path)) {
    throw StudyError(path.string() +
                     ": no such world file (looked from here and from the study's folder): " +
                     "correct the path, or name a shipped world: " + joined(shipped_worlds()));
  }
  if (path.extension() == ".csv") return read_world_csv(path);
  if (path.extension() == ".mat") return read_world_mat(path);
  throw StudyError(
      path.string() +
      ": unknown kind of world file (known: .csv and .mat): convert it to one of them");
}

World find_world(const std::string& name, const std::vector<fs::path>& folders) {
  if (is_path(name)) return read_world_file(resolved_path(name, folders));
  if (const auto shipped = shipped_file("worlds", name + ".csv")) return read_world_csv(*shipped);
  throw StudyError("unknown world '" + name + "' (neither shipped nor a path to .csv or .mat): " +
                   nearest_spelling(name, shipped_worlds()));
}

std::vector<std::string> shipped_worlds() { return shipped_names("worlds", ".csv"); }

}  // namespace montecarta::experiments
