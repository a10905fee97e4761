// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/worker.hpp"
#include "tests/doubles/allocation_count.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scripted_study.hpp"

namespace montecarta::engine {
namespace {

constexpr std::size_t kSteps = 40;

/// One scripted cell on the bench: run after run with the same filter, recorder and record.
struct Bench {
  explicit Bench(const ScriptedFilter::Script& script,
                 ColumnSelection columns = {.particles = true, .map = true},
                 const Parallel& parallel = Parallel::serial())
      : cell(scripted_cell("bench", script)),
        layout(cell, columns, drives.itinerary()),
        spare(parallel, 1),
        filter(cell.make_filter()) {}

  RunEnd run(std::uint64_t number) {
    drives.generate(number, drive);
    return run_one({7, number, drives.itinerary(), drive, spare, stop}, *filter, recorder, record);
  }
  std::span<double> column(std::string_view name) {
    return record.column<double>(layout.find(name).value());
  }

  ScriptedDrives drives{kSteps};
  Cell cell;
  RecordLayout layout;
  SpareThreads spare;
  StopRequest stop;
  Drive drive;
  std::unique_ptr<SlamFilter> filter;
  RunRecord record{layout};
  Recorder recorder{record};
};

TEST(RunOne, RecordsEveryStepOfACompleteRun) {
  Bench bench({});
  EXPECT_EQ(bench.run(0), RunEnd::recorded);
  EXPECT_EQ(bench.record.status(), RunStatus::complete);
  EXPECT_EQ(bench.column("pose_mean").size(), 3 * kSteps);
  EXPECT_THAT(bench.column("pose_mean"), Each(Not(IsNan())));
  EXPECT_THAT(bench.column("nis"), Each(Not(IsNan())));
  EXPECT_GE(bench.record.cpu_seconds(), 0.0);
}

TEST(RunOne, GivesEachRunItsOwnNumbers) {
  Bench bench({});
  ASSERT_EQ(bench.run(0), RunEnd::recorded);
  const std::uint64_t first = bench.record.fingerprint();
  ASSERT_EQ(bench.run(1), RunEnd::recorded);
  EXPECT_NE(bench.record.fingerprint(), first);
}

void expect_failed_at_17(Mishap::Kind kind, std::string_view reason) {
  Bench bench({.mishap = Mishap{.kind = kind}}, {.covariance = false});
  EXPECT_EQ(bench.run(0), RunEnd::recorded);
  EXPECT_EQ(bench.record.status(), RunStatus::failed);
  EXPECT_EQ(bench.record.failure_step(), 17U);
  const std::span<const char> text = bench.record.failure_text();
  EXPECT_EQ(std::string(text.begin(), std::ranges::find(text, '\0')), reason);
  const std::span<double> means = bench.column("pose_mean");
  EXPECT_THAT(means.first(3 * 17), Each(Not(IsNan())));
  EXPECT_THAT(means.subspan(3 * 18), Each(IsNan()));
  EXPECT_THAT(bench.column("ess").subspan(4), Each(IsNan()));
}

// The covariance is checked although it is not recorded.
TEST(RunOne, FailsWithStepAndReason) {
  using enum Mishap::Kind;
  expect_failed_at_17(throws, "scripted mishap of run 0");
  expect_failed_at_17(pose_is_nan, "estimated pose is not finite");
  expect_failed_at_17(covariance_is_infinite, "pose covariance is not finite");
}

TEST(RunOne, NoticesAFailureAtTheNextScanWhereRowsAreScans) {
  Bench bench({.mishap = Mishap{.kind = Mishap::Kind::pose_is_nan}}, {.scans_only = true});
  EXPECT_EQ(bench.run(0), RunEnd::recorded);
  EXPECT_EQ(bench.record.status(), RunStatus::failed);
  EXPECT_EQ(bench.record.failure_step(), 19U);
}

TEST(RunOne, DropsTheRunWhenAskedToStop) {
  Bench bench({});
  bench.stop.make(StopReason::sigterm);
  EXPECT_EQ(bench.run(0), RunEnd::dropped);
  EXPECT_EQ(bench.record.status(), RunStatus::missing);
}

TEST(RunOne, AllocatesNothingAfterTheFirstRun) {
  Bench bench({.particles = 100});
  for (const std::uint64_t warm_up : {2, 3}) ASSERT_EQ(bench.run(warm_up), RunEnd::recorded);
  const std::size_t before = n_allocations;
  for (std::uint64_t run = 0; run < 10; ++run) ASSERT_EQ(bench.run(run), RunEnd::recorded);
  EXPECT_EQ(n_allocations - before, 0U);
}

}  // namespace
}  // namespace montecarta::engine
