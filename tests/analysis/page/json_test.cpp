// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/json.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace montecarta::analysis {
namespace {

TEST(Json, RoundsNumbersToWhatIsSeenAndSaysWhatIsNone) {
  const double infinite = std::numeric_limits<double>::infinity();
  const std::vector<double> numbers = {
      1.0,      0.1 + 0.2, 123456.7, 1e-9, -2.50001e-4, std::numeric_limits<double>::quiet_NaN(),
      infinite, -infinite};
  EXPECT_EQ(script_text(rounded(numbers)), R"([1,0.3,123460.0,1e-09,-0.00025,null,"+inf","-inf"])");
  EXPECT_EQ(script_text(rounded(0.123456, 2)), "0.12");
}

TEST(Json, TextCannotEndTheScriptItStandsIn) {
  EXPECT_EQ(script_text("</script> \"quoted\" \\ \n \xc3\xa9"),
            "\"\\u003c/script> \\\"quoted\\\" \\\\ \\n \xc3\xa9\"");
}

}  // namespace
}  // namespace montecarta::analysis
