// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/printed.hpp"

#include "engine/errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

using testing::HasSubstr;

const std::string kLines =
    "source = A paper, 2016\n"
    "runs = 30\n"
    "value = cell=srcd_m100 metric=position_error printed=2.8211 note=\"Table 1, last row\"\n"
    "value = cell=a metric=cpu_seconds printed=1.8 relative_to=b runs=5\n"
    "claim = position_rmse srcd_m100 < a note=\"Fig. 3\"\n"
    "claim = ess a ~ b\n"
    "assume = two loops: the paper does not say\n";

TEST(Printed, ReadsBackAsItIsWritten) {
  const Printed printed =
      printed_in("[study]\nname = x\n[printed]\n" + kLines + "[world]\nlandmark = 1, 2\n");
  EXPECT_EQ(printed_text(printed), kLines);
  EXPECT_EQ(printed.runs, 30u);
  ASSERT_EQ(printed.values.size(), 2u);
  EXPECT_EQ(printed.values[0].note, "Table 1, last row");
  EXPECT_EQ(printed.values[1].runs, 5u);
  ASSERT_EQ(printed.claims.size(), 2u);
  EXPECT_EQ(printed.claims[1].relation, '~');
}

TEST(Printed, IsEmptyWhereAStudyRepeatsNothing) {
  EXPECT_TRUE(printed_in("[study]\nname = x\n[world]\nlandmark = 1, 2\n").empty());
}

TEST(Printed, KnowsHowFineAPaperRounds) {
  PrintedValue value;
  value.printed = "2.8211";
  EXPECT_DOUBLE_EQ(value.rounding(), 0.00005);
  EXPECT_DOUBLE_EQ(value.number(), 2.8211);
  value.printed = "80";
  EXPECT_DOUBLE_EQ(value.rounding(), 0.5);
}

std::string complaint(const std::string& key, const std::string& text) {
  Printed printed;
  printed.source = "given";
  try {
    take_printed_line(key, text, printed);
  } catch (const StudyError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Printed, BadLinesAreAnsweredWithARemedy) {
  EXPECT_THAT(complaint("value", "cell=a metric=ess"), HasSubstr("printed= is missing: write"));
  EXPECT_THAT(complaint("value", "cell=a metric=ess printed=much"), HasSubstr("is no number"));
  EXPECT_THAT(complaint("value", "cell=a cell=b metric=ess printed=1"), HasSubstr("given twice"));
  EXPECT_THAT(complaint("value", "cell=a colour=red printed=1"), HasSubstr("'colour=red'"));
  EXPECT_THAT(complaint("value", "cell=a metric=ess printed=1 note=Table"),
              HasSubstr("in double quotes"));
  EXPECT_THAT(complaint("value", "cell=a metric=ess printed=1 runs=0"), HasSubstr("above 0"));
  EXPECT_THAT(complaint("claim", "ess a b"), HasSubstr("write claim = METRIC LABEL < LABEL"));
  EXPECT_THAT(complaint("claim", "ess a <b"), HasSubstr("write claim"));
  EXPECT_THAT(complaint("assume", ""), HasSubstr("says nothing"));
  EXPECT_THAT(complaint("source", "again"), HasSubstr("given twice"));
  EXPECT_THAT(complaint("vale", "x"), HasSubstr("unknown key printed.vale"));
}

TEST(Printed, HasTheBandsAndTheBaselineOfAPaper) {
  Printed printed;
  take_printed_line("runs", "20", printed);
  take_printed_line("baseline", "fastslam2", printed);
  take_printed_line("band", "position 1.3 2.79", printed);
  ASSERT_NE(printed.find_band("position"), nullptr);
  EXPECT_EQ(printed.find_band("position")->upper, 2.79);
  EXPECT_EQ(printed.find_band("pose"), nullptr);
  EXPECT_EQ(printed_text(printed), "runs = 20\nbaseline = fastslam2\nband = position 1.3 2.79\n");
  for (const char* text : {"position 1.3", "place 1 2", "pose 2 1", "pose 1 x", "position 1 2"}) {
    EXPECT_THROW(take_printed_line("band", text, printed), StudyError) << text;
  }
  EXPECT_THROW(take_printed_line("baseline", "ekf_slam", printed), StudyError);
}

}  // namespace
}  // namespace montecarta::analysis
