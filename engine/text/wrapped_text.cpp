// SPDX-License-Identifier: BSD-3-Clause
#include "engine/text/wrapped_text.hpp"

#include "engine/namespaces.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>
#include <sys/ioctl.h>

namespace montecarta::engine {
namespace {

constexpr std::size_t kUsualWidth = 80;
constexpr std::size_t kLeastWidth = 40;

std::size_t characters_of(std::string_view text) {
  const auto begins_one = [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; };
  return static_cast<std::size_t>(std::ranges::count_if(text, begins_one));
}

std::size_t width_in_environment() {
  const char* columns = std::getenv("COLUMNS");
  const long width = columns == nullptr ? 0 : std::strtol(columns, nullptr, 10);
  return width > 0 ? static_cast<std::size_t>(width) : kUsualWidth;
}

/// The character that represents a space at which no line ends.
constexpr char kKept = '\x1f';

/// A number and its percent sign are one word.
std::string with_kept_spaces(std::string text) {
  for (std::size_t at = text.find(" %"); at != text.npos; at = text.find(" %", at))
    text[at] = kKept;
  return text;
}

std::string wrapped_paragraph(const std::string& text, std::size_t width, std::size_t hang) {
  if (characters_of(text) <= width) return text + '\n';
  std::string line(std::min(text.find_first_not_of(' '), text.size()), ' ');
  const std::string indent(line.size() + hang, ' ');
  std::istringstream words(with_kept_spaces(text));
  std::string lines;
  bool begins_line = true;
  for (std::string word; words >> word; begins_line = false) {
    if (!begins_line && characters_of(line) + 1 + characters_of(word) > width) {
      lines += line + '\n';
      line = indent;
      begins_line = true;
    }
    line += (begins_line ? "" : " ") + word;
  }
  lines += (begins_line ? "" : line) + '\n';
  std::ranges::replace(lines, kKept, ' ');
  return lines;
}

}  // namespace

std::optional<std::size_t> terminal_width(int descriptor) {
  winsize size{};
  if (ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return std::nullopt;
  return size.ws_col;
}

std::size_t output_width(int descriptor) {
  const std::optional<std::size_t> width = terminal_width(descriptor);
  return std::max(kLeastWidth, width ? *width : width_in_environment());
}

std::string wrapped(std::string_view text, std::size_t width, std::size_t hang) {
  std::istringstream paragraphs{std::string(text)};
  std::string lines;
  for (std::string paragraph; std::getline(paragraphs, paragraph);)
    lines += wrapped_paragraph(paragraph, width, hang);
  return lines;
}

std::string listing(const std::vector<std::pair<std::string, std::string>>& items,
                    std::size_t indent, std::size_t widest) {
  constexpr std::size_t kNarrowestText = 16;
  std::size_t longest = 0;
  for (const auto& [name, description] : items) {
    if (name.size() <= widest) longest = std::max(longest, name.size());
  }
  const std::size_t column = indent + longest + 2;
  const std::size_t width = std::max(output_width(), column + kNarrowestText);
  std::string text;
  for (const auto& [name, description] : items) {
    std::string line = std::string(indent, ' ') + name;
    if (name.size() > longest || description.empty()) {
      text += line + '\n';
      line.clear();
    }
    std::istringstream lines(wrapped(description, width - column));
    for (std::string part; std::getline(lines, part); line.clear()) {
      line.resize(column, ' ');
      text += line + part + '\n';
    }
  }
  return text;
}

std::string first_sentence(const std::string& text) {
  for (std::size_t at = text.find(". "); at != text.npos; at = text.find(". ", at + 1)) {
    if (at + 2 < text.size() && std::isupper(static_cast<unsigned char>(text[at + 2])) != 0)
      return text.substr(0, at);
  }
  return text;
}

}  // namespace montecarta::engine
