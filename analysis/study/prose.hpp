// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// A text file beside the sources, built into the program: paragraphs below headings `## key`.
struct ProseFile {
  std::string_view name;  ///< file name without folder and extension
  std::string_view text;
};
std::span<const ProseFile> prose_files();

/// {key}{paragraph} Texts; each paragraph is one line.
using ProseTexts = std::map<std::string, std::vector<std::string>, std::less<>>;

/// Splits a text file. A text without a heading, a heading without a text and a key that is given
/// twice are our mistakes (expect()).
ProseTexts read_prose(std::string_view text);

/// Names of {placeholders} with the texts that replace them.
using Values = std::vector<std::pair<std::string_view, std::string>>;

/// The paragraphs below `## key` in the file `name`, with their {placeholders} filled in. An
/// unknown key, a placeholder without a value and a value that is not used are our mistakes
/// (expect()).
std::vector<std::string> paragraphs(std::string_view name, std::string_view key,
                                    const Values& values = {});

/// The paragraph of a key that has only one; otherwise like paragraphs().
std::string prose(std::string_view name, std::string_view key, const Values& values = {});

/// The text with every `from` replaced by `to`.
std::string replaced(std::string text, std::string_view from, std::string_view to);

/// The name of the only file that has `## key`.
std::string_view file_of_prose(std::string_view key);

}  // namespace montecarta::analysis
