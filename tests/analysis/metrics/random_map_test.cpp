// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/calibration.hpp"
#include "analysis/metrics/cramer_rao.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "engine/records/merge.hpp"
#include "tests/analysis/studied_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace montecarta::analysis {
namespace {

class RandomMaps : public ::testing::Test {
 protected:
  ResultFile studied(const std::string& name, std::vector<std::string> overrides) const {
    overrides.emplace_back("scenario.map=random");
    write_studied_result(folder_ / name, kTinyLoop, overrides);
    return ResultFile(folder_ / name);
  }
  /// Some runs of the same study.
  void write_shard(const std::string& name, std::uint64_t first, std::uint64_t last) const {
    const experiments::Study study = experiments::parse_study(
        kTinyLoop, "tiny.ini", ".", std::vector<std::string>{"scenario.map=random"});
    run_study(experiments::make_plan(study, experiments::RunRange{first, last}),
              {.output = folder_ / name, .quiet = true});
  }
  ScratchFolder folder_;
};

TEST_F(RandomMaps, AreStoredRunByRun) {
  const ResultFile file = studied("out.h5", {"scenario.map_shift=3"});
  ASSERT_TRUE(file.has_own_landmarks());
  const auto first = file.landmarks_of(0), second = file.landmarks_of(1);
  ASSERT_EQ(first.size(), file.landmarks().size());
  for (std::size_t l = 0; l < first.size(); ++l) {
    const Eigen::Vector2d world(file.landmarks()[l].first, file.landmarks()[l].second);
    EXPECT_LE((first[l] - world).norm(), 3.0);
    EXPECT_NE(first[l], second[l]);
  }
}

TEST_F(RandomMaps, AreTheYardstickOfTheirOwnRuns) {
  const StudyAnalysis study =
      analyze(studied("out.h5", {"scenario.noise=matched", "scenario.map_shift=3"}));
  const CellAnalysis& cell = study.cells.front();
  EXPECT_LT(cell.over_runs("landmark_rms").mean, 1.0)
      << "the world's landmarks are 2 m away on the average";
  EXPECT_GT(study.bound.map / cell.over_runs("landmark_rms").mean, 0.3);
  EXPECT_EQ(study.bound.runs, 6u);
  ASSERT_EQ(cell.get<Calibrations>().size(), 14u);
  EXPECT_EQ(cell.get<Calibrations>().back().test.verdict, Calibration::untested) << "six runs";
}

TEST_F(RandomMaps, MakeEveryRunsBoundItsOwnThoughThePathIsTheSame) {
  EXPECT_EQ(analyze(studied("out.h5", {})).bound.runs, 6u);
  EXPECT_TRUE(analyze(studied("out.h5", {})).cells.front().get<Calibrations>().empty())
      << "not where the noise is on the controls";
}

TEST_F(RandomMaps, SurviveAMerge) {
  const ResultFile whole = studied("whole.h5", {});
  write_shard("a.h5", 0, 2);
  write_shard("b.h5", 2, 6);
  merge_results(folder_ / "merged.h5", {folder_ / "a.h5", folder_ / "b.h5"}, Existing::refuse);
  const ResultFile merged(folder_ / "merged.h5");
  for (std::size_t run = 0; run < 6; ++run) {
    EXPECT_EQ(merged.landmarks_of(run), whole.landmarks_of(run));
  }
}

TEST_F(RandomMaps, AreAbsentWhereTheMapIsFixed) {
  write_studied_result(folder_ / "out.h5", kTinyLoop);
  const ResultFile file(folder_ / "out.h5");
  EXPECT_FALSE(file.has_own_landmarks());
  EXPECT_EQ(file.landmarks_of(3)[1], Eigen::Vector2d(13, 5));
}

}  // namespace
}  // namespace montecarta::analysis
