// SPDX-License-Identifier: BSD-3-Clause
// Law: whoever reads a result file without us finds the ANEES that we find.
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/csv_table.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
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
  const std::string script = R"(
import sys, montecarta
results = montecarta.open(sys.argv[1])
tables = results.tables(sys.argv[2])
verdicts = tables["consistency"]
for label in results.labels:
    cell = montecarta.at_scans(results[label])
    assert list(cell.component.values) == ["x", "y", "heading"], cell.component
    assert cell.pose_mean.attrs["units"] == "m, m, rad" and cell.sizes["scan"] == len(cell.scan_row)
    estimate = cell.get("pose_mean_mixture", cell.pose_mean)
    error = montecarta.pose_error(cell.truth, estimate).sel(component=["x", "y"])
    rmse = (error ** 2).sum("component", skipna=False).mean("run").values ** 0.5
    theirs = tables["series_" + label]["position_rmse [m]"].values
    assert abs(rmse / theirs - 1).max() < 1e-12, label
    print(label, *verdicts.query("cell == @label and error == 'pose'").anees_mean[:1])
for wrong, error in [(lambda: results["none"], KeyError),
                     (lambda: montecarta.open("/none"), OSError)]:
    try:
        wrong()
        sys.exit("nothing was raised")
    except error:
        pass
)";
  std::ofstream(folder_ / "try.py") << script;
  const auto whole = folder_ / "whole.h5";
  write_synthetic_result(whole, 12, 400);
  const auto outcome = run_program("HDF5_USE_FILE_LOCKING= PYTHONPATH=" + kReaders +
                                   " /usr/bin/python3 -B " + (folder_ / "try.py").string() + " " +
                                   whole.string() + " " + MONTECARTA_EXECUTABLE);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_EQ(printed(outcome.output).size(), 2u) << outcome.output;
}

TEST_F(SlowReaders, Figure) {
  if (!python_has("xarray, netCDF4, h5py, matplotlib"))
    GTEST_SKIP() << "python3-matplotlib or what montecarta.py needs is not installed";
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

}  // namespace
}  // namespace montecarta::analysis
