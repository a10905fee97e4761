// SPDX-License-Identifier: BSD-3-Clause
// Drive, filter and recorder of a run allocate nothing after the first runs, in every filter and
// mode and on simulated drives of every kind. Three rare things do allocate: the column joint, at
// 16 scans of a run; resampling of thousands of particles in parts; and a known map, once a run.
#include "engine/runs/worker.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/study/make_plan.hpp"
#include "tests/doubles/allocation_count.hpp"
#include "tests/experiments/commands/program.hpp"

#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

/// Number of particles from which they are resampled in parts.
constexpr std::size_t kManyParticles = 2048;

/// Studies in a small world.
class RunAllocation : public BlinkProgram {
 protected:
  static void expect_at_most(std::size_t allocations, const StudyPlan& plan) {
    const SpareThreads spare(Parallel::serial(), 1);
    const StopRequest stop;
    const std::vector<RecordLayout> layouts = layouts_of(plan, Detail::usual);
    Drive drive;
    for (std::size_t c = 0; c < plan.cells.size(); ++c) {
      const auto filter = plan.cells[c].make_filter();
      RunRecord record(layouts[c]);
      Recorder recorder(record);
      const auto make_run = [&](std::uint64_t run) {
        plan.drives->generate(run, drive);
        return run_one({plan.seed, run, plan.drives->itinerary_of(run), drive, spare, stop},
                       *filter, recorder, record);
      };
      for (const std::uint64_t run : {0U, 1U}) ASSERT_EQ(make_run(run), RunEnd::recorded);
      const std::size_t before = n_allocations;
      const RunEnd end = make_run(1);
      const std::size_t made = n_allocations - before;
      if (plan.cells[c].particles < kManyParticles) {
        EXPECT_LE(made, allocations) << plan.cells[c].label;
      }
      EXPECT_EQ(end, RunEnd::recorded);
      EXPECT_EQ(record.status(), RunStatus::complete) << plan.cells[c].label;
    }
  }
  StudyPlan plan_of(const std::filesystem::path& study, std::vector<std::string> more) const {
    more.insert(more.end(), {"study.runs=2", "scenario.world=" + (folder_ / "blink.csv").string()});
    return make_plan(read_study(study, known_filters(), more));
  }
};

const std::filesystem::path kEveryFilter = std::filesystem::path(MONTECARTA_SOURCE_DIR) /
                                           "tests/experiments/fingerprints/every_filter.ini";

TEST_F(RunAllocation, IsNoneInEveryFilterWithEveryColumn) {
  const std::string columns =
      "record.columns=pose, covariance, ancestry, particles, association, map, final_map";
  expect_at_most(0, plan_of(kEveryFilter, {columns}));
  expect_at_most(0, plan_of(kEveryFilter, {"association.kind=nearest", "record.rate=control"}));
}

TEST_F(RunAllocation, IsNoneInEverySimulator) {
  for (const char* noise : {"matched", "measured-control"}) {
    for (const char* vehicle : {"rear_wheel", "differential_drive", "omnidirectional"}) {
      SCOPED_TRACE(std::string(noise) + ", " + vehicle);
      expect_at_most(0,
                     plan_of(folder_ / "blink.ini", {std::string("scenario.noise=") + noise,
                                                     std::string("scenario.vehicle=") + vehicle}));
    }
  }
}

TEST_F(RunAllocation, IsThatOfTheMapIfItIsKnown) {
  for (const char* sigma : {"0", "0.1"}) {
    expect_at_most(3, plan_of(folder_ / "blink.ini",
                              {"belief.map=known", std::string("belief.map_sigma_m=") + sigma,
                               "belief.start_sigma_m=0.1"}));
  }
}

}  // namespace
}  // namespace montecarta::experiments
