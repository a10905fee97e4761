// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/prose.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"

#include <algorithm>

namespace montecarta::analysis {
namespace {

constexpr std::string_view kProseHeading = "## ";

std::string heading_text(std::string_view name, std::string_view key) {
  return formatted("{}.md, ## {}", name, key);
}

using AllProse = std::map<std::string_view, ProseTexts>;

const AllProse& all_prose() {
  static const AllProse all = [] {
    AllProse texts;
    for (const ProseFile& file : prose_files()) {
      const bool is_new = texts.emplace(file.name, read_prose(file.text)).second;
      expect(is_new, "two files of prose have the same name");
    }
    return texts;
  }();
  return all;
}

/// Fills in values, and counts in `uses` {value} how often each was used.
std::string filled(const std::string& text, const Values& values, std::vector<int>& uses,
                   const std::string& where) {
  std::string result;
  std::size_t at = 0;
  for (std::size_t open = 0; (open = text.find('{', at)) != text.npos;) {
    const std::size_t close = text.find('}', open);
    expect(close != text.npos, (where + ": a { without }").c_str());
    const std::string_view name = std::string_view(text).substr(open + 1, close - open - 1);
    std::size_t k = 0;
    while (k < values.size() && values[k].first != name) ++k;
    expect(k < values.size(), formatted("{}: no value for {}", where, name).c_str());
    ++uses[k];
    result.append(text, at, open - at).append(values[k].second);
    at = close + 1;
  }
  return result.append(text, at);
}

}  // namespace

ProseTexts read_prose(std::string_view text) {
  ProseTexts texts;
  std::vector<std::string>* current = nullptr;
  bool is_continued = false;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    if (line.starts_with(kProseHeading)) {
      expect(current == nullptr || !current->empty(), "a heading without a text");
      const auto [found, is_new] =
          texts.try_emplace(std::string(line.substr(kProseHeading.size())));
      expect(is_new, "a key of prose that is given twice");
      current = &found->second;
      is_continued = false;
    } else if (line.empty()) {
      is_continued = false;
    } else {
      expect(current != nullptr, "a text without a heading");
      if (!is_continued) current->emplace_back();
      current->back().append(is_continued ? " " : "").append(line);
      is_continued = true;
    }
  }
  expect(current != nullptr && !current->empty(), "a heading without a text");
  return texts;
}

std::vector<std::string> paragraphs(std::string_view name, std::string_view key,
                                    const Values& values) {
  const std::string where = heading_text(name, key);
  const auto file = all_prose().find(name);
  expect(file != all_prose().end(), (where + ": no such file").c_str());
  const auto found = file->second.find(key);
  expect(found != file->second.end(), (where + ": no such key").c_str());
  std::vector<int> uses(values.size());
  std::vector<std::string> all;
  for (const std::string& text : found->second) all.push_back(filled(text, values, uses, where));
  for (std::size_t k = 0; k < values.size(); ++k) {
    expect(uses[k] > 0, formatted("{}: {{{}}} is not used", where, values[k].first).c_str());
  }
  return all;
}

std::string prose(std::string_view name, std::string_view key, const Values& values) {
  const std::vector<std::string> all = paragraphs(name, key, values);
  expect(all.size() == 1, (heading_text(name, key) + ": one paragraph is expected").c_str());
  return all.front();
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string_view file_of_prose(std::string_view key) {
  std::vector<std::string_view> names;
  for (const auto& [name, texts] : all_prose()) {
    if (texts.contains(key)) names.push_back(name);
  }
  expect(names.size() == 1, formatted("## {}: one file is expected to have it", key).c_str());
  return names.front();
}

}  // namespace montecarta::analysis
