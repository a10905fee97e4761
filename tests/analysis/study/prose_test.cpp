// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/prose.hpp"

#include "tests/source_tree.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <stdexcept>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

/// All C++ of the analysis, without line breaks and the indentation after them.
const std::string& analysis_sources() {
  static const std::string all = [] {
    std::string text;
    for (const auto& [path, lines] : sources::sources()) {
      if (!path.starts_with("analysis/") || !path.ends_with(".cpp")) continue;
      for (const std::string& line : lines) {
        const std::size_t begin = line.find_first_not_of(' ');
        if (begin != std::string::npos) text += line.substr(begin);
      }
    }
    return text;
  }();
  return all;
}

bool is_in_sources(const std::string& text) {
  return analysis_sources().find(text) != std::string::npos;
}

/// Returns whether the sources name a key of a file as section_of(), figure_of() or prose() need
/// it.
bool is_used(std::string_view file, const std::string& key) {
  const std::string figure = "figure ";
  if (key == "section") return is_in_sources("section_of(\"" + std::string(file) + "\"");
  if (!key.starts_with(figure)) return is_in_sources("\"" + key + "\"");
  return is_in_sources("figure_of(\"" + key.substr(figure.size()) + "\"");
}

TEST(Prose, EveryKeyAndPlaceholderIsUsedInTheSources) {
  ASSERT_FALSE(prose_files().empty());
  static const std::regex key_form("section|figure [a-z_]+|[a-z ]+");
  static const std::regex placeholder("[{]([^}]*)[}]");
  std::vector<std::string> faults;
  for (const ProseFile& file : prose_files()) {
    for (const auto& [key, texts] : read_prose(file.text)) {
      const std::string where = std::string(file.name) + ".md, ## " + key;
      if (!std::regex_match(key, key_form)) faults.push_back(where + ": is no key");
      const bool has_title = key == "section" || key.starts_with("figure ");
      if (has_title && texts.size() > 2) faults.push_back(where + ": more than title and text");
      if (!is_used(file.name, key)) faults.push_back(where + ": is not used");
      for (const std::string& text : texts) {
        for (std::sregex_iterator at(text.begin(), text.end(), placeholder), end; at != end; ++at) {
          const bool is_given = is_in_sources("{\"" + at->str(1) + "\",");
          if (!is_given) faults.push_back(where + ": nothing fills in " + at->str());
        }
      }
    }
  }
  EXPECT_THAT(faults, IsEmpty());
}

TEST(Prose, NoLineIsTooLong) {
  for (const ProseFile& file : prose_files()) {
    std::size_t length = 0;
    for (const char c : file.text) {
      length = c == '\n' ? 0 : length + 1;
      ASSERT_LE(length, 100u) << file.name << ".md";
    }
  }
}

TEST(Prose, ParagraphsAreLinesJoinedBySpaces) {
  EXPECT_THAT(
      read_prose("## a\none\ntwo\n\nthree\n## b c\n\n{four}"),
      ElementsAre(Pair("a", ElementsAre("one two", "three")), Pair("b c", ElementsAre("{four}"))));
}

TEST(Prose, TextsThatAreNotWellFormedAreRefused) {
  for (const char* text :
       {"", "one\n", "## a\n", "## a\n\n## b\none\n", "## a\none\n## a\ntwo\n"}) {
    EXPECT_THROW(read_prose(text), std::logic_error) << text;
  }
}

TEST(Prose, ValuesAreFilledIn) {
  EXPECT_EQ(prose("bound", "missing", {{"reason", "of a test"}}),
            "There is no Cramer-Rao bound and no efficiency, since of a test.");
}

TEST(Prose, UnknownKeysAndWrongValuesAreRefused) {
  EXPECT_THROW(prose("no_such_file", "missing"), std::logic_error);
  EXPECT_THROW(prose("bound", "no such key"), std::logic_error);
  EXPECT_THROW(prose("bound", "missing"), std::logic_error);
  EXPECT_THROW(prose("bound", "missing", {{"reason", "a"}, {"other", "b"}}), std::logic_error);
  EXPECT_THROW(prose("bound", "efficiency", {}), std::logic_error);
  EXPECT_THROW(prose("verdict", "notes", {{"level", "a"}, {"lasting", "b"}}), std::logic_error);
  EXPECT_THROW(file_of_prose("figure no_such_figure"), std::logic_error);
}

}  // namespace
}  // namespace montecarta::analysis
