// SPDX-License-Identifier: BSD-3-Clause
// Several attempts at one result, one after the other and at the same time.
#include "engine/errors.hpp"
#include "engine/records/result_file.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/same_results.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_result.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace montecarta::engine {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Attempt : public ::testing::Test {
 protected:
  ResultWriter begin() const { return ResultWriter::attempt(path_, plan_, {{"host", "here"}}); }
  void store_missing(ResultWriter& writer) const {
    for (std::uint64_t run = 0; run < plan_.runs; ++run) {
      if (writer.status(0, run) == RunStatus::missing) store_run(writer, plan_, run);
    }
  }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      found.push_back(entry.path().filename().string());
    std::ranges::sort(found);
    return found;
  }
  void expect_the_whole_and_nothing_else() const {
    EXPECT_THAT(names(), ElementsAre("out.h5"));
    write_result(folder_ / "once.h5", plan_);
    EXPECT_EQ(difference(ResultFile(path_), ResultFile(folder_ / "once.h5")), "");
  }

  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
  StudyPlan plan_ = small_result_plan(4);
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
  StudyPlan other = plan_;
  other.resolved_text += "seed = 8\n";
  EXPECT_THAT(complaint_of([&] { ResultWriter::attempt(path_, other, {}); }),
              HasSubstr("another study"));
  EXPECT_THAT(complaint_of([&] { ResultWriter::attempt(path_, part_of_plan(plan_, 1, 3), {}); }),
              HasSubstr("other runs"));
  EXPECT_THAT(names(), ElementsAre("out.h5.part"));
}

}  // namespace
}  // namespace montecarta::engine
