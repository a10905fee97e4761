// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace montecarta::sources {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;
using Tree = std::map<std::string, Lines>;  // {path from the top, with '/'}

inline const std::vector<std::string> kFolders = {"analysis",    "cluster", "engine",
                                                  "experiments", "filters", "tests"};

inline Lines read_lines(const fs::path& path) {
  std::ifstream file(path);
  Lines lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

inline std::string top_folder_of(const std::string& path) { return path.substr(0, path.find('/')); }

/// The library that a file belongs to: its folder at the top, but the models of vehicle and sensor,
/// which are no filter, are one of their own.
inline std::string library_of(const std::string& path) {
  return path.starts_with("filters/models/") ? "models" : top_folder_of(path);
}

inline bool is_cpp(const std::string& path) {
  return path.ends_with(".cpp") || path.ends_with(".hpp");
}

inline bool is_script(const Lines& lines) { return !lines.empty() && lines[0].starts_with("#!"); }

inline bool is_source(const std::string& path, const Lines& lines) {
  const auto ends = [&](const char* with) { return path.ends_with(with); };
  return is_cpp(path) || is_script(lines) ||
         std::ranges::any_of(std::array{"CMakeLists.txt", ".cmake", ".py", ".m", ".js", ".css"},
                             ends);
}

/// Counts characters of UTF-8, which may have several bytes.
inline std::ptrdiff_t characters_in(const std::string& line) {
  return std::ranges::count_if(line, [](char byte) { return (byte & 0xC0) != 0x80; });
}

/// Every source file below the folders at the top.
inline Tree read_tree(const fs::path& top) {
  Tree tree;
  for (const std::string& folder : kFolders) {
    for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
      if (!entry.is_regular_file()) continue;
      const std::string path = fs::relative(entry.path(), top).generic_string();
      Lines lines = read_lines(entry.path());
      if (is_source(path, lines)) tree.emplace(path, std::move(lines));
    }
  }
  return tree;
}

inline const Tree& sources() {
  static const Tree tree = read_tree(MONTECARTA_SOURCE_DIR);
  return tree;
}

/// The included files as written between the quotes or angle brackets.
inline std::vector<std::string> includes_of(const Lines& lines) {
  static const std::regex include(R"rx(^\s*#\s*include\s*[<"]([^>"]+)[>"])rx");
  std::vector<std::string> names;
  std::smatch match;
  for (const std::string& line : lines) {
    if (std::regex_search(line, match, include)) names.push_back(match[1]);
  }
  return names;
}

/// Numbers that several equations of one document have.
inline std::vector<std::string> numbers_given_twice(const Lines& document) {
  static const std::regex number(R"(\\tag\{([^}]*)\})");
  std::vector<std::string> numbers, twice;
  for (const std::string& line : document) {
    std::smatch found;
    if (std::regex_search(line, found, number)) numbers.push_back(found[1]);
  }
  std::ranges::sort(numbers);
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    if (numbers[i] == numbers[i - 1]) twice.push_back(numbers[i]);
  }
  return twice;
}

}  // namespace montecarta::sources
