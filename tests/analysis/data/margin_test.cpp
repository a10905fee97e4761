// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/margin.hpp"

#include "engine/errors.hpp"

#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

TEST(Margin, IsThatOfTheStudyInTheFile) {
  EXPECT_EQ(margin_in(""), kUsualMargin);
  EXPECT_EQ(margin_in("[study]\nname = a\n[printed]\nwithin = 3\n"), kUsualMargin);
  EXPECT_EQ(margin_in("[study]\nname = a\nwithin = 1.25\n[scenario]\n"), 1.25);
}

TEST(Margin, RefusesWhatIsNone) {
  for (const char* text : {"1", "0.9", "nan", "1.2x", "", "1e9"}) {
    EXPECT_THROW(margin_in(std::string("[study]\nwithin = ") + text), StudyError) << text;
  }
}

}  // namespace
}  // namespace montecarta::analysis
