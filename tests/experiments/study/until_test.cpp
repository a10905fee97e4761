// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/until.hpp"

#include "experiments/study/make_plan.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string study_until(const std::string& rule) {
  return with("runs = 20", "runs = 20\nuntil = " + rule);
}

TEST(Until, IsPartOfTheStudyInOneSpelling) {
  const Study study = parse_study(study_until("position_rmse<2e-2"), "trial.ini", ".");
  ASSERT_TRUE(study.until);
  EXPECT_EQ(text_of(*study.until), "position_rmse < 0.02");
  EXPECT_THAT(resolved_text(study), HasSubstr("until = position_rmse < 0.02\n"));
  EXPECT_TRUE(make_plan(study).is_enough);
  const Study again = parse_study(resolved_text(study), "again.ini", ".");
  EXPECT_EQ(resolved_text(again), resolved_text(study));
}

// Studies without it have the text, and so the SHA-256, that they always had.
TEST(Until, IsNotSaidWhereItIsNotAsked) {
  const Study study = parse_study(kGoodStudy, "trial.ini", ".");
  EXPECT_FALSE(study.until);
  EXPECT_FALSE(make_plan(study).is_enough);
  EXPECT_THAT(resolved_text(study), Not(HasSubstr("until")));
  EXPECT_FALSE(parse_study(study_until(""), "trial.ini", ".").until);
}

TEST(Until, RefusesWhatItCannotDecide) {
  EXPECT_THAT(complaint(study_until("postion_rmse < 1")),
              AllOf(HasSubstr("trial.ini:4"), HasSubstr("did you mean position_rmse?")));
  EXPECT_THAT(complaint(study_until("cpu_seconds < 1")), HasSubstr("processor time"));
  for (const char* rule :
       {"position_rmse", "position_rmse < ", "position_rmse < -1", "position_rmse < 0",
        "position_rmse < 1 < 2", "< 3", "position_rmse > 1"}) {
    EXPECT_THAT(complaint(study_until(rule)), HasSubstr("until = ")) << rule;
  }
}

TEST(Until, MayBeTheVerdict) {
  const Study study = parse_study(study_until(" verdict "), "trial.ini", ".");
  ASSERT_TRUE(study.until);
  EXPECT_EQ(text_of(*study.until), "verdict");
  EXPECT_THAT(resolved_text(study), HasSubstr("until = verdict\n"));
  EXPECT_TRUE(make_plan(study).is_enough);
  EXPECT_THROW(make_plan(study, RunRange{0, 10}), StudyError);
  EXPECT_THAT(in_words(*study.until, 1000), HasSubstr("widened for up to 6 looks"));
}

TEST(Until, IsNoVerdictWithoutACovariance) {
  const std::vector<std::string> poses = {"record.columns=pose"};
  const Study study = parse_study(study_until("verdict"), "trial.ini", ".", poses);
  try {
    make_plan(study);
    FAIL() << "a study was planned whose verdict never comes";
  } catch (const StudyError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("trial.ini:4"), HasSubstr("add covariance")));
  }
}

TEST(Until, NeedsAllRuns) {
  const Study study = parse_study(study_until("position_rmse < 1"), "trial.ini", ".");
  EXPECT_THROW(make_plan(study, RunRange{0, 10}), StudyError);
}

}  // namespace
}  // namespace montecarta::experiments
