// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace montecarta::experiments {

/// One `key = value` of an INI text, and where it stands.
struct IniEntry {
  std::string section;
  std::string key;
  std::string value;
  std::string place;  ///< "file:line"
};

/// A `[section]` line, and where it stands.
struct IniSection {
  std::string name;
  std::string place;
};

/// What an INI text says, in its order.
struct IniText {
  std::vector<IniSection> sections;
  std::vector<IniEntry> entries;
};

/// Reads INI: sections in brackets, `key = value`, # begins a comment. `name` stands before line
/// numbers. Throws StudyError at stray text and at entries before the first section.
IniText read_ini(const std::string& text, const std::string& name);

}  // namespace montecarta::experiments
