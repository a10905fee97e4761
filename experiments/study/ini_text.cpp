// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/ini_text.hpp"

#include "engine/errors.hpp"
#include "experiments/text/words.hpp"

#include <boost/program_options/parsers.hpp>

#include <sstream>

namespace montecarta::experiments {
namespace {

namespace po = boost::program_options;

/// Where the sections and entries of a text stand; Program_options does not tell. Entries have
/// places only.
IniText index_of(const std::string& text, const std::string& name) {
  IniText index;
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::string_view content = trimmed(std::string_view(line).substr(0, line.find('#')));
    const std::string place = name + ":" + std::to_string(number);
    if (content.empty()) continue;
    if (content.front() == '[' && content.back() == ']') {
      index.sections.push_back({std::string(content.substr(1, content.size() - 2)), place});
    } else if (trimmed(content.substr(0, content.find('='))).empty() ||
               content.find('=') == content.npos) {
      throw StudyError(place + ": stray text '" + std::string(content) +
                       "' (a line is [section] or key = value): complete it, or put # before it");
    } else if (index.sections.empty()) {
      throw StudyError(place + ": '" + std::string(content) +
                       "' stands before any section: put [study] above it");
    } else {
      index.entries.push_back({index.sections.back().name, {}, {}, place});
    }
  }
  return index;
}

}  // namespace

IniText read_ini(const std::string& text, const std::string& name) {
  IniText ini = index_of(text, name);
  std::istringstream stream(text);
  const po::options_description anything;
  const auto options = po::parse_config_file(stream, anything, true).options;
  expect(options.size() == ini.entries.size(), "the INI parser and the index of lines disagree");
  for (std::size_t i = 0; i < options.size(); ++i) {
    IniEntry& entry = ini.entries[i];
    entry.key = options[i].string_key.substr(entry.section.size() + 1);
    entry.value = options[i].value.empty() ? "" : options[i].value.front();
  }
  return ini;
}

}  // namespace montecarta::experiments
