// SPDX-License-Identifier: BSD-3-Clause
// Runs that are stored in full: the first record.full_runs of a study.
#include "engine/errors.hpp"
#include "engine/records/h5.hpp"
#include "engine/records/merge.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_file.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "engine/runs/recompute.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/result_writing.hpp"
#include "tests/doubles/same_results.hpp"

namespace montecarta::engine {
namespace {

std::vector<std::string> names_of(std::span<const Column> columns) {
  std::vector<std::string> names;
  for (const Column& column : columns) names.push_back(column.name);
  return names;
}

/// Four runs, of which two are full.
class FullRuns : public ResultWriting {
 protected:
  FullRuns() {
    plan_ = small_result_plan(4);
    plan_.columns = {.ancestry = false, .full_runs = 2};
  }
};

TEST_F(FullRuns, HaveAllThatAReplayNeedsBehindTheUsualColumns) {
  const ResultDescription d = describe(plan_, {});
  EXPECT_THAT(names_of(d.cells[0].full()), ElementsAre("ancestor", "particle_pose", "log_weight",
                                                       "map_mean", "map_covariance", "map_seen"));
  EXPECT_TRUE(d.cells[0].has("pose_covariance"));
  EXPECT_FALSE(d.cells[0].has("particle_pose"));
  EXPECT_EQ(d.full_runs_here(), 2U);
  EXPECT_EQ(describe(part_of_plan(plan_, 1, 4), {}).full_runs_here(), 1U);
  EXPECT_EQ(describe(part_of_plan(plan_, 2, 4), {}).full_runs_here(), 0U);
}

TEST_F(FullRuns, HoldNothingMoreWhereEveryRunHasIt) {
  plan_.columns = {.particles = true, .map = true, .full_runs = 2};
  write_result(path_, plan_);
  const ResultFile file(path_);
  EXPECT_TRUE(file.cells()[0].full().empty());
  EXPECT_FALSE(h5::has(h5::open_file(path_), "cells/scripted_m4/full"));
}

TEST_F(FullRuns, AreHandedBackBitByBitAndOthersAreNot) {
  write_result(path_, plan_);
  const ResultFile file(path_);
  const StoredCell& cell = file.cells()[1];
  ASSERT_EQ(file.description().full_runs, 2U);
  for (std::uint64_t run = 0; run < plan_.runs; ++run) {
    FilledRecord filled(plan_, 1, run);
    for (const Column& column : cell.full()) {
      EXPECT_EQ(file.holds(cell, column.name, run), run < 2) << column.name << run;
      std::vector<double> read(column.elements());
      if (run >= 2) {
        EXPECT_THROW(file.read(cell, column.name, run, read), std::runtime_error);
        continue;
      }
      file.read(cell, column.name, run, read);
      if (column.element != Element::f64) continue;
      const auto stored = filled.column<double>(column.name);
      EXPECT_TRUE(same_bits(read, stored)) << column.name << run;
    }
  }
}

TEST_F(FullRuns, LeaveTheOtherColumnsAsTheyAre) {
  write_result(path_, plan_);
  StudyPlan plain = plan_;
  plain.columns.full_runs = 0;
  write_result(folder_ / "plain.h5", plain);
  const ResultFile file(path_), other(folder_ / "plain.h5");
  EXPECT_FALSE(h5::has(h5::open_file(folder_ / "plain.h5"), "full_run"));
  EXPECT_EQ(difference(other, file), "");
  const auto fingerprints = [&](const std::filesystem::path& path) {
    std::vector<std::uint64_t> values(plan_.runs);
    h5::read(h5::open_dataset(h5::open_file(path), "cells/scripted_m4/fingerprint"), Element::u64,
             std::as_writable_bytes(std::span(values)));
    return values;
  };
  EXPECT_EQ(fingerprints(path_), fingerprints(folder_ / "plain.h5"));
}

TEST_F(FullRuns, HaveAFingerprintOfTheirOwn) {
  write_result(path_, plan_);
  const CellSlabs cell = find_slabs(path_, describe(plan_, {})).cells[0];
  const auto is_whole = [&](std::size_t run) {
    std::vector<std::byte> buffer;
    return run_is_whole(PosixFile(path_, PosixFile::Mode::read), cell, run, buffer);
  };
  for (const Slab& slab : {cell.columns.back(), cell.full_fingerprint}) {
    ASSERT_EQ(slab.runs, 2U);
    EXPECT_TRUE(is_whole(1));
    flip_bit(path_, slab.at(1));
    EXPECT_FALSE(is_whole(1));
    EXPECT_TRUE(is_whole(0));
    EXPECT_TRUE(is_whole(2));
    flip_bit(path_, slab.at(1));
  }
}

TEST_F(FullRuns, AreResumedWhereTheyWereTorn) {
  write_result(folder_ / "whole.h5", plan_);
  begin();
  flip_bit(part_, find_slabs(part_, describe(plan_, {})).cells[0].columns.back().at(0));
  {
    ResultWriter writer = resume();
    EXPECT_EQ(writer.status(0, 0), RunStatus::missing);
    EXPECT_EQ(writer.status(1, 0), RunStatus::complete);
    writer.write(0, 0, FilledRecord(plan_, 0, 0).record);
    for (std::uint64_t run = 1; run < plan_.runs; ++run) store_run(writer, plan_, run);
    writer.finish();
  }
  EXPECT_EQ(difference(ResultFile(folder_ / "whole.h5"), ResultFile(path_)), "");
}

TEST_F(FullRuns, AreMergedFromShardsOfWhichSomeHoldNone) {
  write_result(folder_ / "whole.h5", plan_);
  write_result(folder_ / "a.h5", part_of_plan(plan_, 0, 1));
  write_result(folder_ / "b.h5", part_of_plan(plan_, 1, 3));
  write_result(folder_ / "c.h5", part_of_plan(plan_, 2, 4));
  EXPECT_EQ(ResultFile(folder_ / "c.h5").cells()[0].full().size(), 6U);
  for (const std::vector<std::string>& order :
       {std::vector<std::string>{"a.h5", "b.h5", "c.h5"}, {"c.h5", "b.h5", "a.h5"}}) {
    std::vector<std::filesystem::path> shards;
    for (const std::string& name : order) shards.push_back(folder_ / name);
    merge_results(path_, shards, Existing::replace);
    const ResultFile merged(path_);
    EXPECT_EQ(difference(ResultFile(folder_ / "whole.h5"), merged), "");
    for (std::size_t run = 0; run < 4; ++run) merged.expect_whole(merged.cells()[0], run);
  }
}

TEST_F(FullRuns, AreTheSameOnAnyNumberOfThreadsAndWhenComputedAgain) {
  plan_ = scripted_cells(5);
  plan_.columns = {.full_runs = 3};
  const auto run_on = [&](int threads, const std::string& name) {
    RunOptions options;
    options.output = folder_ / name;
    options.parallel = Parallel(Backend::tbb, threads);
    options.quiet = true;
    run_study(plan_, options);
  };
  run_on(1, "one.h5");
  run_on(4, "four.h5");
  const ResultFile one(folder_ / "one.h5"), four(folder_ / "four.h5");
  EXPECT_EQ(difference(one, four), "");
  const Recomputation again(one.path(), one.description(), plan_);
  for (std::size_t run = 0; run < 5; ++run) {
    EXPECT_EQ(again.difference({0, run}), std::nullopt) << run;
  }
  flip_bit(one.path(), find_slabs(one.path(), one.description()).cells[0].columns.back().at(2));
  EXPECT_THAT(again.difference({0, 2}).value_or(""), HasSubstr("map_seen differs in 1 of"));
}

TEST_F(FullRuns, AreNotOfAnotherNumberThanPlanned) {
  write_result(folder_ / "a.h5", part_of_plan(plan_, 0, 2));
  plan_.columns.full_runs = 1;
  write_result(folder_ / "b.h5", part_of_plan(plan_, 2, 4));
  EXPECT_THROW(merge_results(path_, {folder_ / "a.h5", folder_ / "b.h5"}, Existing::refuse),
               StudyError);
}

}  // namespace
}  // namespace montecarta::engine
