// SPDX-License-Identifier: BSD-3-Clause
// Law: independent software (SciPy, and the formulas of FilterPy and navlie) finds the same numbers
// in the same file.
#include "analysis/output/csv_file.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

/// Both cells meet the same noise, so that their differences would all be ties but for rounding:
/// noise of its own makes the second one a filter like any other.
void add_noise(std::size_t cell, std::uint64_t run, RunRecord& record) {
  if (cell == 0) return;
  RngStream draw({.seed = 6, .run = run, .purpose = Draw::test});
  const auto mixture = record.layout().find("pose_mean_mixture");
  const auto leading = mixture ? mixture : record.layout().find("pose_mean");
  for (double& value : record.column<double>(*leading)) value += 0.3 * draw.normal();
}

/// Particle filters that have no mixture: their verdict is of the corrected spread.
void leave_out_mixtures(StudyPlan& plan) {
  plan.cells = {scripted_cell("scripted_m60", {.particles = 60}),
                scripted_cell("scripted_m20", {.particles = 20})};
  for (Cell& cell : plan.cells) cell.mixture = false;
}

/// Filters that know pose and map together, in a world whose landmarks have names.
void store_joint_estimates(StudyPlan& plan) {
  plan.columns.joint = true;
  plan.scenario.emplace_back("association.kind", "known");
  for (Cell& cell : plan.cells) cell.joint = true;
}

class SlowRecompute : public testing::Test {
 protected:
  void SetUp() override {
    if (!python_has("scipy, h5py")) GTEST_SKIP() << "python3-scipy, python3-h5py are not installed";
  }

  void write_bounds() const {
    CsvFile file(folder_ / "bounds.csv");
    file.row(std::vector<std::string>{"runs", "dimension", "level", "lower", "upper"});
    for (const std::uint64_t runs : {1u, 2u, 7u, 30u, 100u, 1000u, 20'000u}) {
      for (const std::uint64_t dimension : {1u, 2u, 3u, 63u}) {
        for (const double level : {0.5, 0.9, 0.95, 0.99, 0.999}) {
          const Interval bounds = nees_bounds(runs, dimension, level);
          file.row({static_cast<double>(runs), static_cast<double>(dimension), level, bounds.lower,
                    bounds.upper});
        }
      }
    }
    file.close();
  }

  void montecarta(const std::string& words) const {
    const auto outcome = run_program(std::string(MONTECARTA_EXECUTABLE) + " " + words);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
  }

  void expect_same_numbers(std::uint64_t runs, const std::string& baseline,
                           const std::function<void(StudyPlan&)>& change = {}) const {
    const std::string result = folder_ / "out.h5", analyzed = folder_ / "analyzed",
                      compared = folder_ / "compared";
    write_synthetic_result(result, runs, 400, add_noise, change);
    write_bounds();
    montecarta("analyze " + result + " --csv " + analyzed);
    montecarta("compare " + result + " --baseline " + baseline + " --csv " + compared);
    const auto outcome = run_program(std::string("HDF5_USE_FILE_LOCKING= /usr/bin/python3 ") +
                                     MONTECARTA_SOURCE_DIR + "/tests/analysis/recompute.py " +
                                     result + " " + analyzed + " " + compared + " " +
                                     (folder_ / "bounds.csv").string() + " " + baseline);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_THAT(outcome.output, testing::HasSubstr(", 0 differ"));
  }

  ScratchFolder folder_;
};

TEST_F(SlowRecompute, AFewRunsWithExactTests) { expect_same_numbers(12, "scripted_m4"); }
TEST_F(SlowRecompute, ManyRunsWithTheNormalApproximation) {
  expect_same_numbers(64, "scripted_m4");
}
TEST_F(SlowRecompute, TheSpreadOfFewParticlesCorrected) {
  expect_same_numbers(12, "scripted_m60", leave_out_mixtures);
}
TEST_F(SlowRecompute, PoseAndMapTogether) {
  expect_same_numbers(12, "scripted_m4", store_joint_estimates);
}

}  // namespace
}  // namespace montecarta::analysis
