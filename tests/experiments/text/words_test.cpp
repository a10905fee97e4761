// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/text/words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

using testing::ElementsAre;

TEST(Words, AreCutAndJoined) {
  EXPECT_THAT(split(" a, b ,,c", ','), ElementsAre("a", "b", "", "c"));
  EXPECT_THAT(split("", ','), ElementsAre(""));
  EXPECT_EQ(joined(std::vector<std::string>{"a", "b"}), "a, b");
}

TEST(EditDistance, CountsSlipsOfThePen) {
  EXPECT_EQ(edit_distance("wheelbase", "wheelbase"), 0U);
  EXPECT_EQ(edit_distance("weelbase", "wheelbase"), 1U);
  EXPECT_EQ(edit_distance("wehelbase", "Wheelbase"), 1U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
}

TEST(NearestSpelling, IsOfferedOnlyWhereItIsNear) {
  const std::vector<std::string> known = {"runs", "seed"};
  EXPECT_EQ(nearest_spelling("rnus", known), "did you mean runs?");
  EXPECT_EQ(nearest_spelling("wheelbase", known), "known: runs, seed");
}

TEST(Numbers, AreWholeTextsAndFinite) {
  EXPECT_EQ(to_number("+1.5e2"), 150.0);
  for (const char* bad : {"", "1.5 ", "1,5", "nan", "inf", "-inf", "1e999", "0x10", "five"})
    EXPECT_FALSE(to_number(bad)) << bad;
  EXPECT_EQ(to_count("18446744073709551615"), 18446744073709551615U);
  for (const char* bad : {"", "-1", "1.0", "1e3", "18446744073709551616"})
    EXPECT_FALSE(to_count(bad)) << bad;
}

TEST(Numbers, ReadBackAsWritten) {
  for (const double value : {0.1, 1.0 / 3.0, 1e-300, -123456.789, 5e-324})
    EXPECT_EQ(to_number(to_text(value)), value);
}

}  // namespace
}  // namespace montecarta::experiments
