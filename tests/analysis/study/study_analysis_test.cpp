// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/study_analysis.hpp"

#include "analysis/run/cramer_rao.hpp"
#include "analysis/run/measured_run.hpp"
#include "analysis/run/reference_scores.hpp"
#include "analysis/study/cell_sums.hpp"
#include "analysis/study/map_error_sums.hpp"
#include "analysis/study/reference_sums.hpp"
#include "analysis/study/study_comparison.hpp"
#include "analysis/verdict/calibration.hpp"
#include "analysis/verdict/joint_nees.hpp"
#include "engine/errors.hpp"
#include "engine/records/merge.hpp"
#include "experiments/study/known_filters.hpp"
#include "tests/analysis/recorded_result.hpp"
#include "tests/analysis/studied_result.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

namespace montecarta::analysis {
namespace {

class StudyAnalysisOfAFile : public ::testing::Test {
 protected:
  void SetUp() override { write_synthetic_result(path_); }
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
};

TEST_F(StudyAnalysisOfAFile, JudgesEveryCellAndNamesFailedRuns) {
  EXPECT_THROW(analyze(ResultFile(path_), 95.0), StudyError);
  const StudyAnalysis study = analyze(ResultFile(path_));
  ASSERT_EQ(study.cells.size(), 2u);
  EXPECT_EQ(study.times.size(), 100u);
  EXPECT_EQ(study.cells[0].complete, 12u);
  EXPECT_EQ(study.cells[0].leading, Moments::corrected);
  EXPECT_EQ(study.cells[0].verdict.answer, Answer::undecided) << "of 12 runs";
  EXPECT_EQ(analyze(ResultFile(path_), 0.95, Parallel::serial(), 20.0).cells[0].verdict.within,
            20.0);
  EXPECT_EQ(study.cells[1].verdict.answer, Answer::optimistic);
  ASSERT_EQ(study.cells[1].failures.size(), 1u);
  EXPECT_EQ(study.cells[1].complete, 11u);
  EXPECT_EQ(study.cells[1].failures[0].run, 11u);
  EXPECT_EQ(study.cells[1].failures[0].step, 5u);
  EXPECT_EQ(study.cells[1].failures[0].reason, "gain is <not> a number & worse");
  EXPECT_TRUE(study.has_failures());
  EXPECT_NEAR(study.cells[1].over_runs("position_mse").mean,
              9.0 * study.cells[0].over_runs("position_mse").mean, 0.5);
}

/// Poses that a scan drew all at one place claim nothing: too few of them are left.
TEST_F(StudyAnalysisOfAFile, TakesNoSpreadOfZeroForAClaim) {
  write_synthetic_result(path_, 12, 400, [](std::size_t cell, std::uint64_t, RunRecord& record) {
    if (cell != 0) return;
    const auto covariance = record.column<double>(*record.layout().find("pose_covariance"));
    std::ranges::fill(covariance.first(9), 0.0);
  });
  const Verdict found = analyze(ResultFile(path_)).cells[0].verdict;
  EXPECT_TRUE(found.beside.exact.empty());
  EXPECT_EQ(found.answer, Answer::undecided);
}

/// An index that is none: the message names file, cell and run.
TEST_F(StudyAnalysisOfAFile, RefusesAncestorsThatAreNoParticles) {
  const auto spoil = [](std::size_t cell, std::uint64_t run, RunRecord& record) {
    if (cell != 1 || run != 7) return;
    record.column<std::uint16_t>(*record.layout().find("ancestor")).back() = 3;  // of 0, 1 and 2
  };
  write_synthetic_result(path_, 12, 40, spoil);
  EXPECT_THAT(engine::complaint_of([&] { analyze(ResultFile(path_)); }),
              testing::StartsWith(path_.string() + ": cell 'scripted_m3', run 7: "));
}

/// With a truth, and recorded.
TEST_F(StudyAnalysisOfAFile, GivesTheSameBitsForAnyNumberOfThreads) {
  write_recorded_result(folder_ / "recorded.h5");
  for (const auto& path : {path_, folder_ / "recorded.h5"}) {
    const ResultFile file(path);
    const StudyAnalysis one = analyze(file), many = analyze(file, 0.95, Parallel(Backend::tbb, 3));
    for (std::size_t c = 0; c < one.cells.size(); ++c) {
      const CellAnalysis &a = one.cells[c], &b = many.cells[c];
      for (std::size_t i = 0; i < a.nees.size(); ++i) {
        EXPECT_EQ(a.nees[i].series.average, b.nees[i].series.average);
      }
      for (const char* score : {"position_rmse", "reference_aligned_rms"}) {
        const std::vector<double> x = a.scores.column(score), y = b.scores.column(score);
        EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(double)), 0) << score;
      }
      const auto &fixes = a.get<ReferenceAnalyses>(), &others = b.get<ReferenceAnalyses>();
      for (std::size_t r = 0; r < fixes.size(); ++r) {
        EXPECT_EQ(fixes[r].error_over_time, others[r].error_over_time);
      }
    }
  }
}

TEST(ARecordedDrive, IsJudgedByItsReferencesWithoutAVerdict) {
  const ScratchFolder folder;
  write_recorded_result(folder / "out.h5");
  const StudyAnalysis study = analyze(ResultFile(folder / "out.h5"));
  EXPECT_FALSE(study.has_truth);
  EXPECT_EQ(study.beacons, 4u);
  ASSERT_EQ(study.references.size(), 2u);
  EXPECT_EQ(study.references[0].name, "gps");
  EXPECT_TRUE(study.references[0].has_heading);
  EXPECT_FALSE(study.references[1].has_heading);
  EXPECT_EQ(study.references[1].times.size(), 300u);  // of 320: ten before, ten after the drive
  for (const CellAnalysis& cell : study.cells) {
    EXPECT_TRUE(cell.nees.empty());
    EXPECT_EQ(cell.verdict.answer, Answer::untested);
    EXPECT_TRUE(std::isnan(cell.over_runs("position_rmse").mean));
    EXPECT_TRUE(cell.over_time("position_rmse").empty());
    EXPECT_EQ(cell.get<ReferenceAnalyses>().size(), 2u);
  }
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
      plan.cells[0].reports.joint = true;
    });
    return analyze(ResultFile(folder / "out.h5"));
  };
  const StudyAnalysis study = joint_of("known");
  ASSERT_EQ(study.joint_times.size(), 16u);
  EXPECT_EQ(study.joint_times.back(), study.times.back());
  EXPECT_EQ(study.cells[0].get<JointConsistency>().verdict.answer, Answer::optimistic)
      << "its means are all wrong";
  EXPECT_EQ(study.cells[0].get<JointConsistency>().dimension.back(), 9.0);
  EXPECT_GT(study.cells[0].scores.column("joint_nees")[1], 1.0);
  EXPECT_FALSE(study.cells[1].get<JointConsistency>().stored);
  const StudyAnalysis unknown = joint_of("nearest");
  EXPECT_EQ(unknown.cells[0].get<JointConsistency>().verdict.answer, Answer::untested);
  EXPECT_TRUE(std::isnan(unknown.cells[0].scores.column("joint_nees")[1]));
}

class RandomMaps : public ::testing::Test {
 protected:
  ResultFile studied(const std::string& name, std::vector<std::string> overrides) const {
    overrides.emplace_back("scenario.map=random");
    write_studied_result(folder_ / name, kTinyLoop, overrides);
    return ResultFile(folder_ / name);
  }
  /// Some runs of the same study.
  void write_shard(const std::string& name, std::uint64_t first, std::uint64_t last) const {
    const experiments::Study study =
        experiments::parse_study(kTinyLoop, "tiny.ini", ".", experiments::known_filters(),
                                 std::vector<std::string>{"scenario.map=random"});
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
    const Eigen::Vector2d world = file.landmarks()[l];
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
  ASSERT_EQ(cell.get<Calibrations>().size(), 18u);
  EXPECT_EQ(cell.get<Calibrations>().back().test.verdict, Calibration::untested) << "six runs";
}

TEST_F(RandomMaps, MakeEveryRunsBoundItsOwnThoughThePathIsTheSame) {
  EXPECT_EQ(analyze(studied("out.h5", {})).bound.runs, 6u);
  const StudyAnalysis study = analyze(studied("out.h5", {}));
  for (const JudgedPits& one : study.cells.front().get<Calibrations>()) {
    EXPECT_EQ(one.quantity, "NEES") << "errors are not judged where noise is on the controls";
  }
  EXPECT_EQ(study.cells.front().get<Calibrations>().size(), 4u);
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

TEST(FirstValues, AreThoseOfTheAnalysis) {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 10, 80);
  const ResultFile file(folder / "out.h5");
  const StudyAnalysis study = analyze(file);
  for (const std::string name : {"position_rmse", "nees"}) {
    const Score& score = *find_score(name);
    for (std::size_t c = 0; c < 2; ++c) {
      const auto values = first_values(file, file.cells()[c], score, 7, Parallel(Backend::tbb, 2));
      ASSERT_EQ(values.size(), 7u);
      for (std::size_t i = 0; i < 7; ++i)
        EXPECT_EQ(values[i], study.cells[c].scores.column(score.name)[i]);
    }
  }
  const auto all =
      first_values(file, file.cells()[1], *find_score("position_rmse"), 10, Parallel::serial());
  EXPECT_EQ(all.size(), 9u) << "the failed run has none";
}

}  // namespace
}  // namespace montecarta::analysis
