// SPDX-License-Identifier: BSD-3-Clause
// Law: other readers of a result file find the ANEES that we find.
#include "analysis/render/tables/files.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/study/frame.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/csv_table.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <sstream>

namespace montecarta::analysis {
namespace {

const std::string kReaders = std::string(MONTECARTA_SOURCE_DIR) + "/analysis/readers";

class SlowReaders : public testing::Test {
 protected:
  SlowReaders() { write_synthetic_result(path_, 12, 400, spoil_estimates); }

  /// ANEES of each cell as `montecarta analyze --csv` has it, of the mixture where there is one.
  std::map<std::string, double> ours() const {
    const auto outcome = run_program(std::string(MONTECARTA_EXECUTABLE) + " analyze " +
                                     path_.string() + " --csv " + (folder_ / "csv").string());
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    std::map<std::string, double> anees;
    for (const auto& row : read_csv(folder_ / "csv/consistency.csv")) {
      if (row.at("error") != "pose" || row.at("covariance") == "corrected") continue;
      anees.try_emplace(row.at("cell"), std::stod(row.at("anees_mean")));  // the mixture is first
    }
    EXPECT_EQ(anees.size(), 2u);
    return anees;
  }

  /// Lines of a cell and a number; Octave has more to say.
  static std::map<std::string, double> printed(const std::string& output) {
    std::map<std::string, double> anees;
    std::istringstream lines(output);
    for (std::string line, label; std::getline(lines, line);) {
      double value = 0.0;
      if (std::istringstream(line) >> label >> value) anees[label] = value;
    }
    return anees;
  }

  void expect_same(const std::string& command) const {
    const auto outcome = run_program("HDF5_USE_FILE_LOCKING= " + command);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const auto theirs = printed(outcome.output);
    const auto expected = ours();
    ASSERT_EQ(theirs.size(), expected.size()) << outcome.output;
    for (const auto& [cell, value] : expected) {
      EXPECT_NEAR(theirs.at(cell), value, 1e-12 * value) << cell << ": " << outcome.output;
    }
  }

  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
};

TEST_F(SlowReaders, H5py) {
  if (!python_has("h5py")) GTEST_SKIP() << "h5py (python3-h5py) is not installed";
  expect_same("/usr/bin/python3 -B " + kReaders + "/anees.py " + path_.string());
}

TEST_F(SlowReaders, Xarray) {
  if (!python_has("xarray, netCDF4, h5py"))
    GTEST_SKIP() << "python3-xarray, python3-netcdf4, python3-h5py are not installed";
  expect_same("/usr/bin/python3 -B " + kReaders + "/anees.py " + path_.string() + " --xarray");
}

TEST_F(SlowReaders, TheModuleNamesItsArraysAndReadsTheTables) {
  if (!python_has("xarray, netCDF4, h5py, pandas"))
    GTEST_SKIP()
        << "python3-xarray, python3-netcdf4, python3-h5py, python3-pandas are not installed";
  const auto whole = folder_ / "whole.h5";
  write_synthetic_result(whole, 12, 400);
  const auto outcome = run_program("HDF5_USE_FILE_LOCKING= PYTHONPATH=" + kReaders +
                                   " /usr/bin/python3 -B " MONTECARTA_SOURCE_DIR
                                   "/tests/analysis/module_reader.py " +
                                   whole.string() + " " + MONTECARTA_EXECUTABLE);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_EQ(printed(outcome.output).size(), 2u) << outcome.output;
}

TEST_F(SlowReaders, Figure) {
  if (!python_has("xarray, netCDF4, h5py, matplotlib"))
    GTEST_SKIP() << "python3-matplotlib or what the package montecarta needs is not installed";
  const auto outcome = run_program("HDF5_USE_FILE_LOCKING= /usr/bin/python3 -B " + kReaders +
                                   "/anees_figure.py " + path_.string() + " " +
                                   (folder_ / "anees.svg").string() + " " + MONTECARTA_EXECUTABLE);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "anees.svg"));
}

TEST_F(SlowReaders, Octave) {
  if (!installed("octave")) GTEST_SKIP() << "octave is not installed";
  expect_same("octave --no-gui --norc --eval \"addpath('" + kReaders + "'); anees('" +
              path_.string() + "')\"");
}

// Law: independent software (SciPy, and the formulas of FilterPy and navlie) finds the same numbers
// in the same file.

/// Both cells meet the same noise, so that their differences would all be ties but for rounding:
/// noise of its own makes the second one a filter like any other.
void add_noise(std::size_t cell, std::uint64_t run, RunRecord& record) {
  if (cell == 0) return;
  RngStream draw({.seed = 6, .run = run, .purpose = Draw::test});
  const auto mixture = record.layout().find("pose_mean_mixture");
  const auto leading = mixture ? mixture : record.layout().find("pose_mean");
  for (double& value : record.column<double>(*leading)) value += 0.3 * draw.normal();
}

/// Filters that estimate by one Gaussian.
void leave_out_particles(StudyPlan& plan) {
  plan.columns.ancestry = false;
  plan.columns.particles = false;
  for (Cell& cell : plan.cells) {
    cell.particles = 0;
    cell.reports.mixture = false;
  }
}

/// Particle filters that have no mixture: their verdict is of the corrected spread.
void leave_out_mixtures(StudyPlan& plan) {
  plan.cells = {scripted_cell("scripted_m60", {.particles = 60}),
                scripted_cell("scripted_m20", {.particles = 20})};
  for (Cell& cell : plan.cells) cell.reports.mixture = false;
}

/// Filters with joint estimates, in a world where landmarks are identified.
void store_joint_estimates(StudyPlan& plan) {
  plan.columns.joint = true;
  plan.scenario.emplace_back("association.kind", "known");
  for (Cell& cell : plan.cells) cell.reports.joint = true;
}

class SlowRecompute : public testing::Test {
 protected:
  void SetUp() override {
    if (!python_has("scipy, h5py")) GTEST_SKIP() << "python3-scipy, python3-h5py are not installed";
  }

  void write_bounds() const {
    Frame rows{{{"runs"}, {"dimension"}, {"level"}, {"lower"}, {"upper"}}};
    for (const std::uint64_t runs : {1u, 2u, 7u, 30u, 100u, 1000u, 20'000u}) {
      for (const std::uint64_t dimension : {1u, 2u, 3u, 63u}) {
        for (const double level : {0.5, 0.9, 0.95, 0.99, 0.999}) {
          const Interval bounds = nees_bounds(runs, dimension, level);
          rows.push({static_cast<double>(runs), static_cast<double>(dimension), level, bounds.lower,
                     bounds.upper});
        }
      }
    }
    write_csv(rows, folder_ / "bounds.csv");
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

  void expect_same_verdict(std::uint64_t runs,
                           const std::function<void(StudyPlan&)>& change) const {
    const std::string result = folder_ / "gaussian.h5", analyzed = folder_ / "gaussian";
    write_synthetic_result(result, runs, 400, {}, change);
    montecarta("analyze " + result + " --force --csv " + analyzed);
    const auto outcome = run_program("HDF5_USE_FILE_LOCKING= PYTHONPATH=" + kReaders +
                                     " /usr/bin/python3 -B " + MONTECARTA_SOURCE_DIR +
                                     "/tests/analysis/check_verdict.py " + result + " " + analyzed);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_THAT(outcome.output, testing::HasSubstr(", 0 differ"));
  }

  ScratchFolder folder_;
};

/// 12 and 30 runs have too few groups for the spread between runs, 300 runs have all families.
TEST_F(SlowRecompute, TheVerdictOnTheWholeError) {
  for (const std::uint64_t runs : {12u, 30u, 300u}) expect_same_verdict(runs, leave_out_particles);
}

TEST_F(SlowRecompute, TheVerdictInTheFrameOfTheEstimate) {
  expect_same_verdict(30, [](StudyPlan& plan) {
    leave_out_particles(plan);
    plan.scenario = {{"noise", "matched"}};
  });
}

// The factors behind the gate of one of two sensors, by other quadrature and interpolation.
TEST_F(SlowRecompute, TheVerdictBehindAGate) {
  for (const std::string runs : {"12", "60"}) {
    const auto outcome =
        run_program("HDF5_USE_FILE_LOCKING= PYTHONPATH=" + kReaders + " /usr/bin/python3 -B " +
                    MONTECARTA_SOURCE_DIR + "/tests/analysis/check_gates.py " +
                    MONTECARTA_EXECUTABLE + " " + folder_.path().string() + " " + runs);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_THAT(outcome.output, testing::HasSubstr(", 0 differ"));
  }
}

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
