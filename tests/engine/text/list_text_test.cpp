// SPDX-License-Identifier: BSD-3-Clause
#include "engine/text/list_text.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace montecarta::engine {
namespace {

TEST(ListText, HasAWordBetweenPartsOnly) {
  EXPECT_EQ(joined(std::vector<std::string>{"a", "", "c"}), "a, , c");
  EXPECT_EQ(joined({}), "");
  std::string list;
  append_part(list, "a");
  append_part(list, "b");
  append_part(list, "c", "; ");
  EXPECT_EQ(list, "a, b; c");
}

}  // namespace
}  // namespace montecarta::engine
