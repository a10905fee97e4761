// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/measured_run.hpp"

#include "analysis/metrics/joint_nees.hpp"
#include "analysis/metrics/map_errors.hpp"
#include "analysis/metrics/reference_scores.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "tests/analysis/recorded_result.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

class ARecordedDrive : public ::testing::Test {
 protected:
  void SetUp() override { write_recorded_result(path_); }
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
};

TEST_F(ARecordedDrive, HasReferencesAndNoVerdict) {
  const StudyAnalysis study = analyze(ResultFile(path_));
  EXPECT_FALSE(study.has_truth);
  EXPECT_EQ(study.beacons, 4u);
  ASSERT_EQ(study.references.size(), 2u);
  EXPECT_EQ(study.references[0].name, "gps");
  EXPECT_TRUE(study.references[0].has_heading);
  EXPECT_FALSE(study.references[1].has_heading);
  EXPECT_EQ(study.references[1].times.size(), 300u);  // of 320: ten before, ten after the drive
  for (const CellAnalysis& cell : study.cells) {
    EXPECT_TRUE(cell.nees.empty());
    EXPECT_EQ(cell.consistency().verdict, Verdict::untested);
    EXPECT_TRUE(std::isnan(cell.over_runs("position_rmse").mean));
    EXPECT_TRUE(cell.over_time("position_rmse").empty());
    EXPECT_EQ(cell.get<ReferenceAnalyses>().size(), 2u);
  }
}

TEST_F(ARecordedDrive, IsJudgedByItsFixes) {
  const StudyAnalysis study = analyze(ResultFile(path_));
  const ReferenceAnalysis& gps =
      study.cells[2].get<ReferenceAnalyses>()[0];  // 0.5 m circles, 3 m aside
  const Spread median = gps.over_runs(&ReferenceScores::median);
  const Spread aligned = gps.over_runs(&ReferenceScores::aligned_median);
  EXPECT_NEAR(median.summary.mean, 3.0, 0.1);
  EXPECT_NEAR(aligned.summary.mean, 0.5 * 1.03, 0.5 / 2.0);  // the wild fix shifts all by 0.45 m
  EXPECT_LT(aligned.least, aligned.greatest);
  const Spread gated = gps.over_runs(&ReferenceScores::gated_rms);
  EXPECT_NEAR(gated.summary.mean, std::hypot(3.0, 0.5 * 1.03), 0.05);
  EXPECT_NEAR(gps.over_runs(&ReferenceScores::gated_share).summary.mean, 299.0 / 300.0, 1e-12);
  EXPECT_NEAR(gps.over_runs(&ReferenceScores::heading_rmse).summary.mean, 0.1, 0.005);
  const ReferenceAnalysis& coarse = study.cells[2].get<ReferenceAnalyses>()[1];
  EXPECT_NEAR(coarse.over_runs(&ReferenceScores::aligned_rms).summary.mean,
              std::sqrt(0.5 + 0.515 * 0.515), 0.05);
  EXPECT_TRUE(std::isnan(coarse.over_runs(&ReferenceScores::heading_rmse).summary.mean));
  EXPECT_EQ(gps.error_over_time.size(), study.references[0].times.size());
}

TEST_F(ARecordedDrive, GivesStudiesTheirScoresByName) {
  const StudyAnalysis study = analyze(ResultFile(path_));
  const CellAnalysis& cell = study.cells[1];
  for (std::size_t i = 0; i < cell.complete; ++i) {
    EXPECT_EQ(cell.scores.column("reference_rms")[i], cell.get<ReferenceAnalyses>()[0].runs[i].rms);
    EXPECT_EQ(cell.scores.column("map_landmarks")[i], 20.0);
    EXPECT_EQ(cell.scores.column("beacons_found")[i], 3.0);
    EXPECT_NEAR(cell.scores.column("beacon_rms")[i], 3.3, 1e-12);
    EXPECT_NEAR(cell.scores.column("beacon_aligned_rms")[i], 0.3, 0.5);  // the wild fix, as above
  }
  EXPECT_GT(cell.scores.column("reference_aligned_median")[1], 30.0);
  ASSERT_EQ(cell.over_time("map_landmarks").size(), 300u);
  EXPECT_EQ(cell.over_time("map_landmarks")[35], 3.0);
}

TEST_F(ARecordedDrive, GivesTheSameBitsForAnyNumberOfThreads) {
  const ResultFile file(path_);
  const StudyAnalysis one = analyze(file), many = analyze(file, 0.95, Parallel(Backend::tbb, 3));
  for (std::size_t c = 0; c < one.cells.size(); ++c) {
    const ReferenceAnalysis &a = one.cells[c].get<ReferenceAnalyses>()[0],
                            &b = many.cells[c].get<ReferenceAnalyses>()[0];
    EXPECT_EQ(a.error_over_time, b.error_over_time);
    EXPECT_EQ(a.over_runs(&ReferenceScores::aligned_rms).summary.mean,
              b.over_runs(&ReferenceScores::aligned_rms).summary.mean);
  }
}

TEST(ADriveWithTruth, HasNoReferences) {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 3, 80);
  const StudyAnalysis study = analyze(ResultFile(folder / "out.h5"));
  EXPECT_TRUE(study.has_truth);
  EXPECT_TRUE(study.references.empty());
  for (const CellAnalysis& cell : study.cells) {
    EXPECT_TRUE(cell.get<ReferenceAnalyses>().empty());
    EXPECT_TRUE(cell.over_time("map_landmarks").empty());
    EXPECT_TRUE(std::isnan(cell.scores.column("reference_rms")[0]));
    EXPECT_TRUE(std::isnan(cell.scores.column("beacons_found")[0]));
    EXPECT_FALSE(std::isnan(cell.scores.column("position_rmse")[0]));
    EXPECT_FALSE(cell.nees.empty());
  }
}

/// Weights add up to one but for rounding, and so does the mean size of equal maps.
TEST(ADriveWithTruth, HasWholeMapsDespiteRounding) {
  const ScratchFolder folder;
  const auto map_of_size = [&](double size) {
    write_synthetic_result(folder / "out.h5", 3, 80,
                           [&](std::size_t, std::uint64_t, RunRecord& record) {
                             record.column<double>(*record.layout().find("map_size")).back() = size;
                           });
    return analyze(ResultFile(folder / "out.h5")).cells[0].get<MapErrors>().missing;
  };
  EXPECT_EQ(map_of_size(3.0 + 1e-12), "");
  EXPECT_NE(map_of_size(3.5), "") << "one particle in two has a landmark that is not stored";
}

TEST(ADriveWithTruth, IsJudgedByPoseAndMapTogetherWhereThatIsStored) {
  const ScratchFolder folder;
  const auto joint_of = [&](const char* association) {
    write_synthetic_result(folder / "out.h5", 3, 80, {}, [&](StudyPlan& plan) {
      plan.columns.joint = true;
      plan.scenario.emplace_back("association.kind", association);
      plan.cells[0].joint = true;
    });
    return analyze(ResultFile(folder / "out.h5"));
  };
  const StudyAnalysis study = joint_of("known");
  ASSERT_EQ(study.joint_times.size(), 16u);
  EXPECT_EQ(study.joint_times.back(), study.times.back());
  EXPECT_EQ(study.cells[0].get<JointConsistency>().verdict, Verdict::optimistic)
      << "its means are all wrong";
  EXPECT_EQ(study.cells[0].get<JointConsistency>().dimension.back(), 9.0);
  EXPECT_GT(study.cells[0].scores.column("joint_nees")[1], 1.0);
  EXPECT_FALSE(study.cells[1].get<JointConsistency>().stored);
  const StudyAnalysis unknown = joint_of("nearest");
  EXPECT_EQ(unknown.cells[0].get<JointConsistency>().verdict, Verdict::untested);
  EXPECT_TRUE(std::isnan(unknown.cells[0].scores.column("joint_nees")[1]));
}

}  // namespace
}  // namespace montecarta::analysis
