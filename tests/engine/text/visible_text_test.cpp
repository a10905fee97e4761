// SPDX-License-Identifier: BSD-3-Clause
#include "engine/text/visible_text.hpp"

#include <gtest/gtest.h>

namespace montecarta::engine {
namespace {

TEST(VisibleText, WritesOutTerminalCommandsAndBytesThatAreNoText) {
  EXPECT_EQ(visible("a map, 5 m\xC2\xB2, \xE2\x82\xAC, \xF0\x9F\x97\xBA"),
            "a map, 5 m\xC2\xB2, \xE2\x82\xAC, \xF0\x9F\x97\xBA");
  EXPECT_EQ(visible("\x1b[2J"), "\\x1b[2J");
  EXPECT_EQ(visible("a\nb\tc\r"), "a\\nb\\tc\\x0d");
  EXPECT_EQ(visible("a\nb\tc", "\n\t"), "a\nb\tc");
  EXPECT_EQ(visible("\xC2\x9B"
                    "31m"),
            "\\xc2\\x9b31m")
      << "a control character of two bytes";
  EXPECT_EQ(visible(std::string("\0", 1)), "\\x00");
  EXPECT_EQ(visible("\x7f"), "\\x7f");
  EXPECT_EQ(visible("\xff\xfe"), "\\xff\\xfe");
  EXPECT_EQ(visible("\xE2\x82"), "\\xe2\\x82") << "cut short";
  EXPECT_EQ(visible("\xC0\xAF"), "\\xc0\\xaf") << "overlong";
}

TEST(VisibleText, CountsTheBytesOfACharacterThatIsNotWhole) {
  EXPECT_EQ(unfinished_bytes("ab"), 0u);
  EXPECT_EQ(unfinished_bytes("a\xE2\x82"), 2u);
  EXPECT_EQ(unfinished_bytes("a\xE2\x82\xAC"), 0u);
  EXPECT_EQ(unfinished_bytes("\xF0"), 1u);
  EXPECT_EQ(unfinished_bytes("\xff"), 0u);
}

}  // namespace
}  // namespace montecarta::engine
