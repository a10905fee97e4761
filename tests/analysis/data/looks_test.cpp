// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/looks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Looks, AreTheRoundsOfAStudyThatStopsByVerdict) {
  const std::string text = "[study]\nname = a\nuntil = verdict\n[scenario]\n";
  EXPECT_THAT(looks_in(text, 200), ElementsAre(32, 64, 128, 200));
  EXPECT_THAT(looks_in(text, 20), ElementsAre(20));
}

TEST(Looks, AreNoneOfAnyOtherStudy) {
  EXPECT_THAT(looks_in("", 200), IsEmpty());
  EXPECT_THAT(looks_in("[study]\nuntil = position_rmse < 1\n", 200), IsEmpty());
  EXPECT_THAT(looks_in("[study]\nname = a\n[printed]\nuntil = verdict\n", 200), IsEmpty());
}

}  // namespace
}  // namespace montecarta::analysis
