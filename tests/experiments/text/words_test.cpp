// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/text/words.hpp"

#include "analysis/study/text_table.hpp"
#include "engine/random/stream.hpp"
#include "engine/records/posix_file.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"

namespace montecarta::experiments {
namespace {

TEST(Words, AreCutAtSeparators) {
  EXPECT_THAT(split(" a, b ,,c", ','), ElementsAre("a", "b", "", "c"));
  EXPECT_THAT(split("", ','), ElementsAre(""));
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

TEST(Numbers, AreWholeTextsAndFiniteAndReadBackAsWritten) {
  EXPECT_EQ(to_number("+1.5e2"), 150.0);
  for (const char* bad : {"", "1.5 ", "1,5", "nan", "inf", "-inf", "1e999", "0x10", "five"})
    EXPECT_FALSE(to_number(bad)) << bad;
  EXPECT_EQ(to_count("18446744073709551615"), 18446744073709551615U);
  for (const char* bad : {"", "-1", "1.0", "1e3", "18446744073709551616"})
    EXPECT_FALSE(to_count(bad)) << bad;
  for (const double value : {0.1, 1.0 / 3.0, 1e-300, -123456.789, 5e-324})
    EXPECT_EQ(to_number(to_text(value)), value);
}

TEST(QuotedWords, QuotesHoldAWordTogetherAndMustBeClosed) {
  EXPECT_THAT(quoted_words("  a  b\tc "), ElementsAre("a", "b", "c"));
  EXPECT_THAT(quoted_words(R"(key="a b,c" d)"), ElementsAre("key=a b,c", "d"));
  EXPECT_THAT(quoted_words(R"(python3 'my filter.py' --name="x y" '')"),
              ElementsAre("python3", "my filter.py", "--name=x y", ""));
  EXPECT_THAT(quoted_words(R"("a \"b\" \\ 'c'" '\n' \n)"),
              ElementsAre(R"(a "b" \ 'c')", R"(\n)", R"(\n)"));
  EXPECT_THAT(quoted_words(""), IsEmpty());
  for (const char* text : {"\"", "a 'b", "a \"b\\\"", "'\""}) {
    EXPECT_THAT(complaint_of([&] { quoted_words(text); }), HasSubstr("is not closed")) << text;
  }
}

TEST(QuotedWords, WhateverIsQuotedReadsBack) {
  RngStream random(StreamIdentity{.seed = 1});
  const std::string characters = "ab \t\"'\\$*`;|&\xc3\xa9";
  for (int i = 0; i < 1000; ++i) {
    std::string word;
    for (std::uint32_t n = random.below(12); n > 0; --n)
      word += characters[random.below(static_cast<std::uint32_t>(characters.size()))];
    EXPECT_THAT(quoted_words("x " + in_quotes(word)), ElementsAre("x", word));
  }
}

TEST(Table, AlignsColumnsAndWritesSizesAsPeopleDo) {
  EXPECT_EQ(aligned({{"a", "bb", "c"}, {"ddd", "e"}}), "  a    bb  c\n  ddd  e\n");
  EXPECT_EQ(aligned({{"a", ""}}, 0), "a\n");
  EXPECT_EQ(bytes_text(17), "17 B");
  EXPECT_EQ(bytes_text(999.7), "1.0 kB");
  EXPECT_EQ(bytes_text(3'760'000), "3.8 MB");
  EXPECT_EQ(bytes_text(64e9), "64 GB");
}

}  // namespace
}  // namespace montecarta::experiments
