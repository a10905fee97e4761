// SPDX-License-Identifier: BSD-3-Clause
#include "engine/text/wrapped_text.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <unistd.h>

namespace montecarta::engine {
namespace {

TEST(WrappedText, BreaksBetweenWordsAndKeepsEmptyLinesAndLongWords) {
  EXPECT_EQ(wrapped("one two three four", 9), "one two\nthree\nfour\n");
  EXPECT_EQ(wrapped("one two three four", 9, 2), "one two\n  three\n  four\n");
  EXPECT_EQ(wrapped("  one two\nthree", 7, 1), "  one\n   two\nthree\n");
  EXPECT_EQ(wrapped("a\n\nb", 40), "a\n\nb\n");
  EXPECT_EQ(wrapped("a  table", 8), "a  table\n") << "what fits stays as it is";
  EXPECT_EQ(wrapped("/a/long/path b", 6), "/a/long/path\nb\n");
  EXPECT_EQ(wrapped("", 40), "");
  EXPECT_EQ(wrapped("in 95 % of", 6), "in\n95 %\nof\n");
  EXPECT_EQ(wrapped("\u00b1\u03c3 \u00b1\u03c3", 5), "\u00b1\u03c3 \u00b1\u03c3\n");
}

TEST(WrappedText, WidthOfWhatIsNoTerminalIs80OrThatOfTheEnvironment) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const char* before = std::getenv("COLUMNS");
  const std::string kept = before == nullptr ? "" : before;
  const auto width_with = [&](const char* columns) {
    ::setenv("COLUMNS", columns, 1);
    return output_width(ends[1]);
  };
  EXPECT_EQ(terminal_width(ends[1]), std::nullopt);
  EXPECT_EQ(width_with(""), 80u);
  EXPECT_EQ(width_with("120"), 120u);
  EXPECT_EQ(width_with("7"), 40u);
  EXPECT_EQ(width_with("-3"), 80u);
  ::setenv("COLUMNS", kept.c_str(), 1);
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(FirstSentence, EndsBeforeACapitalLetter) {
  EXPECT_EQ(first_sentence("speed along the path. It is constant."), "speed along the path");
  EXPECT_EQ(first_sentence("as in Kim et al. 2008, eq. (3)"), "as in Kim et al. 2008, eq. (3)");
  EXPECT_EQ(first_sentence("one. "), "one. ");
}

}  // namespace
}  // namespace montecarta::engine
