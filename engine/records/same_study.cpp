// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/open_result.hpp"

#include <algorithm>
#include <sstream>

namespace montecarta::engine {
namespace {

bool same_columns(const StoredCell& a, const StoredCell& b) {
  return a.label == b.label &&
         std::ranges::equal(a.columns, b.columns, [](const Column& x, const Column& y) {
           return x.name == y.name && x.element == y.element && x.shape == y.shape;
         });
}

/// Of a build; flags without the instruction set, on which no bit depends.
std::optional<std::string> fact(const TextPairs& build, const std::string& name) {
  const auto found = std::ranges::find(build, name, [](const auto& pair) { return pair.first; });
  if (found == build.end()) return std::nullopt;
  if (name != "flags") return found->second;
  std::istringstream words(found->second);
  std::string rest;
  for (std::string word; words >> word;) {
    if (!word.starts_with("-march=")) rest += (rest.empty() ? "" : " ") + word;
  }
  return rest;
}

}  // namespace

std::optional<std::string> difference(const ResultDescription& a, const ResultDescription& b,
                                      const std::filesystem::path& path) {
  if (a.study_sha256 != b.study_sha256) {
    return path.string() + ": belongs to another study ('" + b.study_name + "', SHA-256 " +
           b.study_sha256.substr(0, 12) + ", not '" + a.study_name + "', " +
           a.study_sha256.substr(0, 12) +
           "): give the files of one study, made with the same --set";
  }
  if (std::ranges::equal(a.cells, b.cells, same_columns) && a.times == b.times &&
      a.scan_steps == b.scan_steps && a.joint_scans == b.joint_scans)
    return std::nullopt;
  return path.string() +
         ": is laid out differently (another version of montecarta, or of a world file, made it): "
         "make it anew";
}

std::vector<std::string> build_differences(const TextPairs& a, const TextPairs& b) {
  std::vector<std::string> found;
  for (const char* name : {"version", "git", "compiler", "flags", "libm"}) {
    const std::optional<std::string> in_a = fact(a, name), in_b = fact(b, name);
    if (!in_a || !in_b || *in_a == *in_b) continue;
    found.push_back("two builds worked on this study (" + std::string(name) + ": " + *in_a +
                    " and " + *in_b + "): the last digits of their runs may differ");
  }
  return found;
}

}  // namespace montecarta::engine
