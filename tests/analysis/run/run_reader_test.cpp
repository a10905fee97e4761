// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/run_reader.hpp"

#include "analysis/render/figures/ancestry_figure.hpp"
#include "analysis/render/figures/path_figure.hpp"
#include "analysis/render/page/replay/replay.hpp"
#include "analysis/render/tables/terminal.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/threads/parallel.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <sstream>

namespace montecarta::analysis {
namespace {

/// Poses of six runs, and all of the first two.
class RunsInFull : public testing::Test {
 protected:
  static void store(const std::filesystem::path& path, std::uint64_t full_runs) {
    write_synthetic_result(path, 6, 120, {}, [&](StudyPlan& plan) {
      plan.columns = {.ancestry = false, .full_runs = full_runs};
    });
  }
  RunsInFull() : file((store(folder / "out.h5", 2), folder / "out.h5")) {}

  ScratchFolder folder;
  ResultFile file;
};

TEST_F(RunsInFull, GiveAnAnalysisWhatEveryRunHas) {
  const StoredCell& cell = file.cells()[0];
  const RunReader reader(file, cell);
  RunRows rows;
  for (const std::size_t run : {0U, 3U}) {
    reader.read(run, rows);
    EXPECT_THAT(rows.spread.covariance, Not(IsEmpty()));
    EXPECT_THAT(rows.ancestor, IsEmpty());
    EXPECT_THAT(rows.particle_pose, IsEmpty());
    EXPECT_FALSE(rows.final_map.has_value());
  }
}

/// The checks of a file know its columns, but not those that a filter declares.
TEST_F(RunsInFull, AreRefusedIfAScansColumnHasOtherAxes) {
  const StoredCell& cell = file.cells()[0];
  const engine::Column* nis = cell.find("nis");
  ASSERT_NE(nis, nullptr);
  const_cast<engine::Column*>(nis)->axes = {engine::Axis::time};  // in a file without its seal
  RunRows rows;
  EXPECT_THAT([&] { RunReader(file, cell).read(0, rows); },
              testing::ThrowsMessage<StudyError>(HasSubstr("nis has other axes")));
}

TEST_F(RunsInFull, GiveAFigureOfOneRunAllThatIsThere) {
  const StoredCell& cell = file.cells()[0];
  const std::size_t scans = file.scan_times().size();
  const RunRows full = read_run(file, cell, 1), other = read_run(file, cell, 2);
  EXPECT_EQ(full.ancestor.size(), scans * cell.particles);
  EXPECT_EQ(full.particle_pose.size(), 3 * scans * cell.particles);
  EXPECT_THAT(other.ancestor, IsEmpty());
  EXPECT_EQ(StoredMap(file, cell, 1).scans(), scans);
  EXPECT_EQ(StoredMap(file, cell, 2).scans(), 0U);
  EXPECT_THAT(ancestry_figure(file, 1).data, Not(IsEmpty()));
  EXPECT_THAT(ancestry_figure(file, 2).data, IsEmpty());
  EXPECT_THAT(read_replay(file, 1).cells[0].particles.frames, Not(IsEmpty()));
  EXPECT_THAT(read_replay(file, 2).cells[0].particles.frames, IsEmpty());
}

/// HDF5 unpacks data that lie in one piece here.
TEST_F(RunsInFull, AreTheSameInAFileThatAnotherProgramPacked) {
  if (!installed("h5repack")) GTEST_SKIP() << "h5repack (hdf5-tools) is not installed";
  const auto packed = folder / "packed.h5";
  const std::string names = (folder / "out.h5").string() + " " + packed.string();
  ASSERT_EQ(run_program("h5repack -f GZIP=1 " + names).status, 0);
  const ResultFile other(packed);
  const RunRows wanted = read_run(file, file.cells()[0], 1);
  const RunReader reader(other, other.cells()[0], Reach::full_run);
  Parallel(Backend::tbb, 3).for_each(6, [&](std::size_t) {
    RunRows found;
    reader.read(1, found);
    EXPECT_EQ(found.truth, wanted.truth);
    EXPECT_EQ(found.spread.covariance, wanted.spread.covariance);
    EXPECT_EQ(found.resampled, wanted.resampled);
    EXPECT_EQ(found.ancestor, wanted.ancestor);
    EXPECT_EQ(found.particle_pose, wanted.particle_pose);
  });
}

TEST_F(RunsInFull, ChangeNoTableOfTheStudy) {
  store(folder / "plain.h5", 0);
  const auto table_of = [](const ResultFile& of) {
    StudyAnalysis study = analyze(of);
    study.file.clear();
    std::ostringstream table;
    print_all(table, study, 80);
    return table.str();
  };
  EXPECT_EQ(table_of(file), table_of(ResultFile(folder / "plain.h5")));
}

}  // namespace
}  // namespace montecarta::analysis
