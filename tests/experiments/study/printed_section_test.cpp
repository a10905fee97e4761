// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/study_sections.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

using testing::HasSubstr;

std::string complaint_about_printed(const std::string& line) {
  return complaint(kGoodStudy + "[printed]\n" + line + "\n");
}

TEST(PrintedSection, IsPartOfTheResolvedStudy) {
  const Study study = parsed(kGoodStudy +
                             "[printed]\nassume =  one   loop  # a guess\n"
                             "value = printed=1.9 metric=position_rmse cell=ekf_slam\n");
  EXPECT_EQ(study.printed.values.at(0).cell, "ekf_slam");
  const std::string text = resolved_text(study);
  EXPECT_THAT(text, HasSubstr("[printed]\nvalue = cell=ekf_slam metric=position_rmse printed=1.9\n"
                              "assume = one   loop\n[world]"));
  EXPECT_EQ(resolved_text(parsed(text)), text);
  EXPECT_EQ(printed_text(printed_in(text)), printed_text(study.printed));
}

TEST(PrintedSection, IsAbsentWhereNothingIsRepeated) {
  EXPECT_EQ(resolved_text(parsed(kGoodStudy)).find("[printed]"), std::string::npos);
}

TEST(PrintedSection, ErrorsNameLineReasonAndRemedy) {
  EXPECT_THAT(complaint_about_printed("value = cell=ekf_slma metric=ess printed=1"),
              HasSubstr("trial.ini:9: value: there is no cell 'ekf_slma': did you mean ekf_slam?"));
  EXPECT_THAT(complaint_about_printed("value = cell=ekf_slam metric=positon_rmse printed=1"),
              HasSubstr("there is no metric 'positon_rmse': did you mean position_rmse?"));
  EXPECT_THAT(complaint_about_printed("claim = ess ekf_slam < fastslam2"),
              HasSubstr("trial.ini:9: claim: there is no cell 'fastslam2'"));
  EXPECT_THAT(complaint_about_printed("value = cell=ekf_slam metric=ess"),
              HasSubstr("trial.ini:9: value: printed= is missing: write value = "));
  EXPECT_THAT(
      complaint_about_printed("value = cell=ekf_slam metric=stays_above_from_pose printed=1 "
                              "relative_to=ekf_slam"),
      HasSubstr("remove it"));
  EXPECT_THAT(complaint_about_printed("quote = 3"), HasSubstr("unknown key printed.quote"));
}

}  // namespace
}  // namespace montecarta::experiments
