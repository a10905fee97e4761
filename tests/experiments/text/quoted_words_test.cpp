// SPDX-License-Identifier: BSD-3-Clause
#include "engine/random/stream.hpp"
#include "experiments/text/words.hpp"
#include "tests/doubles/complaint.hpp"

#include <gmock/gmock.h>

namespace montecarta::experiments {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(QuotedWords, QuotesHoldAWordTogether) {
  EXPECT_THAT(quoted_words("  a  b\tc "), ElementsAre("a", "b", "c"));
  EXPECT_THAT(quoted_words(R"(key="a b,c" d)"), ElementsAre("key=a b,c", "d"));
  EXPECT_THAT(quoted_words(R"(python3 'my filter.py' --name="x y" '')"),
              ElementsAre("python3", "my filter.py", "--name=x y", ""));
  EXPECT_THAT(quoted_words(R"("a \"b\" \\ 'c'" '\n' \n)"),
              ElementsAre(R"(a "b" \ 'c')", R"(\n)", R"(\n)"));
  EXPECT_THAT(quoted_words(""), IsEmpty());
}

TEST(QuotedWords, AnOpenQuoteIsAMistake) {
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

}  // namespace
}  // namespace montecarta::experiments
