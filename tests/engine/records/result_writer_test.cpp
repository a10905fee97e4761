// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_writer.hpp"

#include "engine/errors.hpp"
#include "engine/records/result_file.hpp"
#include "engine/records/result_layout.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/result_writing.hpp"
#include "tests/doubles/same_results.hpp"

#include <fstream>

namespace montecarta::engine {
namespace {

class ResultWriterTest : public ResultWriting {};

TEST_F(ResultWriterTest, LeavesOnlyTheFinalNameWhenFinished) {
  write_result(path_, plan_);
  EXPECT_THAT(names(), ElementsAre("out.h5"));
}

TEST_F(ResultWriterTest, KeepsWorkInProgressReadable) {
  ResultWriter writer = create();
  store_run(writer, plan_, 1);
  const ResultFile file(part_);
  EXPECT_THAT(file.status(file.cells()[0]),
              ElementsAre(RunStatus::missing, RunStatus::complete, RunStatus::missing));
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(ResultWriterTest, PutsTheStatusBehindAllData) {
  // Law: a run with a status is whole. If the record fails before the status is set, the run stays
  // missing.
  ResultWriter writer = create();
  const RecordLayout layout = layout_of(plan_);
  RunRecord record(layout);
  EXPECT_THROW(writer.write(0, 0, record), std::logic_error);  // neither complete nor failed
  EXPECT_EQ(writer.status(0, 0), RunStatus::missing);
  record.mark_complete(1.0);
  writer.write(0, 0, record);
  EXPECT_EQ(writer.status(0, 0), RunStatus::complete);
  EXPECT_THROW(writer.write(0, 0, record), std::logic_error);  // twice
}

TEST_F(ResultWriterTest, StoresAFailedRunWithStepAndReason) {
  ResultWriter writer = create();
  const RecordLayout layout = layout_of(plan_);
  RunRecord record(layout);
  record.mark_failed(17, "weights vanished", 0.5);
  writer.write(0, 1, record);
  record.mark_failed(3, std::string(127, 'x') + "\u00e9",
                     0.5);  // the last character would be cut in two
  writer.write(0, 2, record);
  const ResultFile file(part_);
  const StoredCell& cell = file.cells()[0];
  EXPECT_EQ(file.status(cell)[1], RunStatus::failed);
  EXPECT_THAT(file.failure_reasons(cell),
              ElementsAre("", "weights vanished", std::string(127, 'x')));
  EXPECT_THAT(file.failure_steps(cell), ElementsAre(0U, 17U, 3U));
}

TEST_F(ResultWriterTest, ResumesWithWhatIsThere) {
  {
    ResultWriter writer = create();
    store_run(writer, plan_, 0);
    store_run(writer, plan_, 2);
    writer.note_wall_seconds(1.5);
  }
  ResultWriter writer = resume();
  EXPECT_EQ(writer.status(1, 0), RunStatus::complete);
  EXPECT_EQ(writer.status(1, 1), RunStatus::missing);
  EXPECT_TRUE(writer.notes().empty());
  store_run(writer, plan_, 1);
  writer.note_wall_seconds(2.0);
  writer.finish();
  EXPECT_EQ(ResultFile(path_).wall_seconds(), 3.5);
}

TEST_F(ResultWriterTest, BeginsWhereThereIsNothingToResume) {
  ResultWriter writer = resume();
  EXPECT_EQ(writer.status(0, 0), RunStatus::missing);
  EXPECT_TRUE(std::filesystem::exists(part_));
}

TEST_F(ResultWriterTest, ResumingAFinishedResultFindsNothingToDo) {
  write_result(path_, plan_);
  const std::string before = text_in(path_);
  ResultWriter writer = resume();
  EXPECT_EQ(writer.status(1, 2), RunStatus::complete);
  writer.note_wall_seconds(1.0);
  writer.finish();
  EXPECT_EQ(text_in(path_), before);
}

TEST_F(ResultWriterTest, ComputesTornRunsAgain) {
  {
    ResultWriter writer = create();
    for (std::uint64_t run = 0; run < 3; ++run) store_run(writer, plan_, run);
  }
  flip_bit(part_, find_slabs(part_, describe(plan_, {})).cells[0].columns[0].at(1));
  ResultWriter writer = resume();
  EXPECT_EQ(writer.status(0, 0), RunStatus::complete);
  EXPECT_EQ(writer.status(0, 1), RunStatus::missing);
  EXPECT_EQ(writer.status(1, 1), RunStatus::complete);
  EXPECT_THAT(writer.notes(), ElementsAre(HasSubstr("1 stored runs were damaged")));
}

TEST_F(ResultWriterTest, RefusesWhatIsThereUnlessForced) {
  write_result(path_, plan_);
  EXPECT_THAT(complaint_of([&] { create(); }), HasSubstr("out.h5: exists"));
  const std::string before = text_in(path_);
  {
    ResultWriter writer = create(Existing::replace);
    EXPECT_EQ(text_in(path_), before) << "the old result goes only when the new one is complete";
  }
  EXPECT_THAT(complaint_of([&] { create(); }), HasSubstr("--force"));
}

TEST_F(ResultWriterTest, RefusesUnfinishedWorkUnlessForced) {
  begin();
  EXPECT_THAT(complaint_of([&] { create(); }), HasSubstr(".part"));
  EXPECT_EQ(create(Existing::replace).status(0, 0), RunStatus::missing);
}

TEST_F(ResultWriterTest, RefusesAnotherStudyAndOtherRuns) {
  begin();
  const std::string before = text_in(part_);
  EXPECT_THAT(complaint_of([&] { ResultWriter::resume(path_, other_study(), {}); }),
              AllOf(HasSubstr("another study"), HasSubstr("SHA-256")));
  EXPECT_THAT(complaint_of([&] { ResultWriter::resume(path_, part_of_plan(plan_, 1, 3), {}); }),
              AllOf(HasSubstr("holds runs 0:3"), HasSubstr("asked for: 1:3")));
  EXPECT_EQ(text_in(part_), before);
}

TEST_F(ResultWriterTest, RefusesAFileThatAnotherProcessWrites) {
  ResultWriter writer = create();
  EXPECT_THAT(complaint_of([&] { resume(); }), HasSubstr("another montecarta process"));
  EXPECT_THAT(complaint_of([&] { create(Existing::replace); }),
              HasSubstr("another montecarta process"));
}

TEST_F(ResultWriterTest, RefusesACutFile) {
  begin();
  std::filesystem::resize_file(part_, std::filesystem::file_size(part_) / 2);
  EXPECT_THAT(complaint_of([&] { resume(); }), HasSubstr("cannot be resumed"));
}

TEST_F(ResultWriterTest, NamesAPathThatCannotBeWritten) {
  path_ = folder_ / "nowhere" / "out.h5";
  EXPECT_THAT(complaint_of([&] { create(); }), HasSubstr("nowhere"));
  path_ = folder_.path();
  EXPECT_THAT(complaint_of([&] { create(); }), HasSubstr("is a folder"));
}

TEST_F(ResultWriterTest, RefusesMoreThanTheDiskHoldsAndMoreRunsThanAFile) {
  plan_ = small_result_plan(9'000'000, 40'000);
  EXPECT_THAT(complaint_of<RunError>([&] { create(); }), HasSubstr("are needed"));
  plan_ = small_result_plan(1'000'000'000'000);
  EXPECT_THAT(complaint_of([&] { create(); }), HasSubstr("--shard"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(ResultWriterTest, LogsAResumptionByAnotherBuild) {
  {
    ResultWriter writer =
        ResultWriter::create(path_, plan_, {{"git", "abc"}, {"host", "a"}}, Existing::refuse);
  }
  const ResultWriter writer = ResultWriter::resume(path_, plan_, {{"git", "def"}, {"host", "a"}});
  EXPECT_THAT(writer.notes(), ElementsAre(AllOf(HasSubstr("abc"), HasSubstr("def"))));
  EXPECT_THAT(text_in(part_), HasSubstr("git=def\n"));
}

class ResumeResult : public ResultWriting {};

TEST_F(ResumeResult, ResumesBesideAnOlderResultOnlyWhereItIsOfTheSameStudyAndRuns) {
  begin();
  const auto older = folder_ / "older.h5";
  write_result(older, other_study());
  std::filesystem::rename(older, path_);
  const std::string before = text_in(path_);
  EXPECT_THAT(complaint_of([&] { resume(); }), HasSubstr("out.h5: exists"));
  EXPECT_EQ(text_in(path_), before);
  write_result(older, part_of_plan(plan_, 1, 3));
  std::filesystem::rename(older, path_);
  EXPECT_THAT(complaint_of([&] { resume(); }), HasSubstr("out.h5: exists"));
  std::ofstream(path_) << "no result at all";
  EXPECT_THAT(complaint_of([&] { resume(); }), HasSubstr("out.h5: exists"));
  write_result(older, plan_);
  std::filesystem::rename(older, path_);
  EXPECT_EQ(resume().status(0, 0), RunStatus::complete);
}

TEST_F(ResumeResult, ReplacesAnotherResultAfterAResumptionWhereTheStartWasForced) {
  write_result(path_, other_study());
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
  EXPECT_THAT(complaint_of([&] { resume(); }), HasSubstr("4 of 6 runs are missing"));
}

// Several attempts at one result, one after the other and at the same time.

class Attempt : public ResultWriting {
 protected:
  Attempt() { plan_ = small_result_plan(4); }
  ResultWriter begin() const { return ResultWriter::attempt(path_, plan_, {{"host", "here"}}); }
  void store_missing(ResultWriter& writer) const {
    for (std::uint64_t run = 0; run < plan_.runs; ++run) {
      if (writer.status(0, run) == RunStatus::missing) store_run(writer, plan_, run);
    }
  }
  void expect_the_whole_and_nothing_else() const {
    EXPECT_THAT(names(), ElementsAre("out.h5"));
    write_result(folder_ / "once.h5", plan_);
    EXPECT_EQ(difference(ResultFile(path_), ResultFile(folder_ / "once.h5")), "");
  }
};

TEST_F(Attempt, HandsOverWhatItStoredUnderOneNameWithoutACopy) {
  {
    ResultWriter first = begin();
    EXPECT_THAT(names(), ElementsAre(HasSubstr("out.h5.part.")));
    store_run(first, plan_, 2);
    first.suspend();
  }
  EXPECT_THAT(names(), ElementsAre("out.h5.part"));
  ResultWriter second = begin();
  EXPECT_THAT(names(), ElementsAre(HasSubstr("out.h5.part.")));
  EXPECT_EQ(second.status(1, 2), RunStatus::complete);
  store_missing(second);
  second.finish();
  expect_the_whole_and_nothing_else();
}

TEST_F(Attempt, TakesOverWhatOneThatDiedOrIsCutOffStored) {
  ResultWriter cut_off = begin();
  store_run(cut_off, plan_, 0);
  ResultWriter second = begin();
  EXPECT_EQ(second.status(0, 0), RunStatus::complete);
  EXPECT_EQ(second.status(0, 1), RunStatus::missing);
  EXPECT_THAT(second.notes(), ElementsAre(HasSubstr("2 runs were taken over from out.h5.part.")));
  store_run(cut_off, plan_, 1);  // goes on alone, and harms nobody
  store_missing(second);
  second.finish();
  store_missing(cut_off);
  cut_off.finish();
  expect_the_whole_and_nothing_else();
}

TEST_F(Attempt, TheOneThatWasCutOffMayBeFirst) {
  ResultWriter cut_off = begin();
  ResultWriter second = begin();
  store_missing(cut_off);
  cut_off.finish();
  store_run(second, plan_, 3);
  second.suspend();
  EXPECT_THAT(begin().notes(), ElementsAre(HasSubstr("is complete already")));
  expect_the_whole_and_nothing_else();
}

TEST_F(Attempt, DamagedRunsAndCutFilesAreNotTakenOver) {
  std::string other;
  {
    const ResultWriter died = begin();
    other = names().front();
  }
  const auto size = std::filesystem::file_size(folder_ / other);
  std::filesystem::copy_file(folder_ / other, folder_ / "out.h5.part.cut");
  std::filesystem::resize_file(folder_ / "out.h5.part.cut", size / 2);
  std::ofstream(folder_ / "out.h5.part") << "torn";
  {
    ResultWriter dies = begin();
    store_run(dies, plan_, 1);
  }
  ResultWriter last = begin();
  EXPECT_EQ(last.status(0, 1), RunStatus::complete);
  EXPECT_EQ(last.status(0, 2), RunStatus::missing);
  store_missing(last);
  last.finish();
  expect_the_whole_and_nothing_else();
}

TEST_F(Attempt, OtherStudiesAndOtherRunsAreRefusedAndKept) {
  begin().suspend();
  EXPECT_THAT(complaint_of([&] { ResultWriter::attempt(path_, other_study(), {}); }),
              HasSubstr("another study"));
  EXPECT_THAT(complaint_of([&] { ResultWriter::attempt(path_, part_of_plan(plan_, 1, 3), {}); }),
              HasSubstr("other runs"));
  EXPECT_THAT(names(), ElementsAre("out.h5.part"));
}

}  // namespace
}  // namespace montecarta::engine
