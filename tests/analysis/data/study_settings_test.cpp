// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/study_settings.hpp"

#include "engine/errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Margin, IsThatOfTheStudyInTheFile) {
  EXPECT_EQ(margin_in(""), kUsualMargin);
  EXPECT_EQ(margin_in("[study]\nname = a\n[record]\nwithin = 3\n"), kUsualMargin);
  EXPECT_EQ(margin_in("[study]\nname = a\nwithin = 1.25\n[scenario]\n"), 1.25);
}

TEST(Margin, RefusesWhatIsNone) {
  for (const char* text : {"1", "0.9", "nan", "1.2x", "", "1e9"}) {
    EXPECT_THROW(margin_in(std::string("[study]\nwithin = ") + text), StudyError) << text;
  }
}

TEST(Looks, AreTheRoundsOfAStudyThatStopsByVerdict) {
  const std::string text = "[study]\nname = a\nuntil = verdict\n[scenario]\n";
  EXPECT_THAT(looks_in(text, 200), ElementsAre(32, 64, 128, 200));
  EXPECT_THAT(looks_in(text, 20), ElementsAre(20));
}

TEST(Looks, AreNoneOfAnyOtherStudy) {
  EXPECT_THAT(looks_in("", 200), IsEmpty());
  EXPECT_THAT(looks_in("[study]\nuntil = position_rmse < 1\n", 200), IsEmpty());
  EXPECT_THAT(looks_in("[study]\nname = a\n[record]\nuntil = verdict\n", 200), IsEmpty());
}

}  // namespace
}  // namespace montecarta::analysis
