// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/open_result.hpp"

#include <algorithm>

namespace montecarta {
namespace {

bool same_columns(const StoredCell& a, const StoredCell& b) {
  return a.label == b.label &&
         std::ranges::equal(a.columns, b.columns, [](const Column& x, const Column& y) {
           return x.name == y.name && x.element == y.element && x.shape == y.shape;
         });
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
  for (const char* name : {"git", "compiler", "flags", "instruction_set"}) {
    const auto named = [&](const auto& pair) { return pair.first == name; };
    const auto in_a = std::ranges::find_if(a, named);
    const auto in_b = std::ranges::find_if(b, named);
    if (in_a == a.end() || in_b == b.end() || in_a->second == in_b->second) continue;
    found.push_back("two builds worked on this study (" + std::string(name) + ": " + in_a->second +
                    " and " + in_b->second + "): the last digits of their runs may differ");
  }
  return found;
}

}  // namespace montecarta
