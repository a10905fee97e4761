// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/json.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace montecarta::analysis {
namespace {

TEST(Json, NestsAndPartsByCommas) {
  JsonWriter json;
  json.begin_object().member("a", 1).key("b").begin_array().value("x").value(true);
  json.begin_object().end_object().end_array().member("c", std::vector<int>{4, 5}).end_object();
  EXPECT_EQ(json.text(), R"({"a":1,"b":["x",true,{}],"c":[4,5]})");
}

TEST(Json, RoundsNumbersToWhatIsSeenAndSaysWhatIsNone) {
  JsonWriter json;
  const double infinite = std::numeric_limits<double>::infinity();
  json.value(std::vector<double>{1.0, 0.1 + 0.2, 123456.7, 1e-9, -2.50001e-4,
                                 std::numeric_limits<double>::quiet_NaN(), infinite, -infinite});
  EXPECT_EQ(json.text(), "[1,0.3,1.2346e+05,1e-09,-0.00025,null,1e999,-1e999]");
}

TEST(Json, TextCannotEndTheScriptItStandsIn) {
  JsonWriter json;
  json.value("</script> \"quoted\" \\ \n \xc3\xa9");
  EXPECT_EQ(json.text(), "\"\\u003c/script> \\\"quoted\\\" \\\\ \\u000a \xc3\xa9\"");
}

}  // namespace
}  // namespace montecarta::analysis
