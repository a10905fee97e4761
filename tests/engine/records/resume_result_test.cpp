// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "engine/records/result_file.hpp"
#include "tests/doubles/result_writing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace montecarta::engine {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ResumeResult : public ResultWriting {};

TEST_F(ResumeResult, ResumesBesideAnOlderResultOnlyWhereItIsOfTheSameStudyAndRuns) {
  begin();
  StudyPlan other = plan_;
  other.resolved_text += "seed = 8\n";
  const auto older = folder_ / "older.h5";
  write_result(older, other);
  std::filesystem::rename(older, path_);
  const std::string before = bytes_of(path_);
  EXPECT_THAT(message<StudyError>([&] { resume(); }),
              AllOf(HasSubstr("out.h5: exists"), HasSubstr("--resume"), HasSubstr("--force")));
  EXPECT_EQ(bytes_of(path_), before);
  write_result(older, part_of_plan(plan_, 1, 3));
  std::filesystem::rename(older, path_);
  EXPECT_THAT(message<StudyError>([&] { resume(); }), HasSubstr("out.h5: exists"));
  std::ofstream(path_) << "no result at all";
  EXPECT_THAT(message<StudyError>([&] { resume(); }), HasSubstr("out.h5: exists"));
  write_result(older, plan_);
  std::filesystem::rename(older, path_);
  EXPECT_EQ(resume().status(0, 0), RunStatus::complete);
}

TEST_F(ResumeResult, ReplacesAnotherResultAfterAResumptionWhereTheStartWasForced) {
  StudyPlan other = plan_;
  other.resolved_text += "seed = 8\n";
  write_result(path_, other);
  begin(Existing::replace);
  ResultWriter writer = resume();
  store_run(writer, plan_, 1);
  store_run(writer, plan_, 2);
  writer.finish();
  EXPECT_EQ(ResultFile(path_).study_text(), plan_.resolved_text);
}

TEST_F(ResumeResult, TellsUnfinishedWorkUnderAFinalNameFromAResult) {
  begin();
  std::filesystem::rename(part_, path_);
  EXPECT_THAT(
      message<StudyError>([&] { resume(); }),
      AllOf(HasSubstr("4 of 6 runs are missing"), HasSubstr("rename it to " + part_.string())));
}

}  // namespace
}  // namespace montecarta::engine
