// SPDX-License-Identifier: BSD-3-Clause
// Localisation in a study: the filters are given the map.
#include "analysis/study/map_error_sums.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/drives/drives_in_known_map.hpp"
#include "experiments/study/make_plan.hpp"
#include "tests/analysis/studied_result.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace montecarta::experiments {
namespace {

const std::string kKnownMap = kGoodStudy + "[belief]\nmap = known\n";

TEST(KnownMap, IsNoPartOfTheTextOfAStudyWithoutIt) {
  const std::string text = resolved_text(parsed(kGoodStudy));
  for (const char* key : {"belief.map", "belief.map_sigma_m", "scenario.map_sigma_m",
                          "scenario.start_sigma_m", "scenario.start_sigma_deg"}) {
    EXPECT_FALSE(resolved_settings(parsed(kGoodStudy)).contains(key)) << key;
  }
  EXPECT_EQ(resolved_text(parsed(kGoodStudy, {"belief.map=estimated", "scenario.map_sigma_m=0"})),
            text);
}

TEST(KnownMap, HasATextThatIsTheSameStudy) {
  const Study study = parsed(kKnownMap, {"scenario.start_sigma_deg=40", "scenario.map_sigma_m=0.5",
                                         "belief.map_sigma_m=0"});
  EXPECT_EQ(resolved_text(parsed(resolved_text(study))), resolved_text(study));
  const auto settings = resolved_settings(study);
  EXPECT_EQ(settings.at("belief.map"), "known");
  EXPECT_EQ(settings.at("belief.map_sigma_m"), "0");
  EXPECT_EQ(settings.at("scenario.map_sigma_m"), "0.5");
}

TEST(KnownMap, IsRefusedWithAFilterThatCannotTakeIt) {
  for (const char* cell : {"smoother", "fixed_lag_smoother", "robocentric_ekf_slam", "fej_ekf_slam",
                           "relative_ekf_slam"}) {
    EXPECT_THAT(complaint(kKnownMap, {"cells.cell=" + std::string(cell)}),
                AllOf(HasSubstr(std::string(cell) + " with belief.map = known"),
                      HasSubstr("use one of ekf_slam, riekf_slam, ukf_slam, right_ukf_slam, "
                                "left_ukf_slam, fastslam1")));
  }
  for (const FilterKind& kind : known_filters()) {
    if (kind.takes_prior || kind.name == "external") continue;
    EXPECT_THAT(complaint(kKnownMap, {"cells.cell=" + kind.name}),
                AllOf(HasSubstr(kind.name + " with belief.map = known (it"),
                      Not(HasSubstr("cannot be started"))))
        << "the reason why is missing";
  }
  EXPECT_EQ(complaint(kKnownMap, {"cells.cell=ukf_slam"}), "nothing");
}

TEST(KnownMap, IsNeededForAnUncertainStart) {
  EXPECT_THAT(complaint(with("runs = 20\n[scenario]", "runs = 20\n[scenario]\nstart_sigma_m = 1")),
              AllOf(HasSubstr("trial.ini:5: scenario.start_sigma_m = 1 with belief.map"),
                    HasSubstr("set belief.map = known")));
  EXPECT_THAT(complaint(kGoodStudy, {"belief.map_sigma_m=1"}),
              HasSubstr("map_sigma_m does not apply to belief.map = estimated"));
}

TEST(KnownMap, HasNoJointCovarianceIfItIsExact) {
  const auto plan = [](const std::vector<std::string>& more) {
    std::vector<std::string> settings{"record.columns=pose, covariance, joint"};
    settings.insert(settings.end(), more.begin(), more.end());
    return complaint_of(
        [&] { make_plan(parsed(kKnownMap, settings), {}, ExternalPrograms::refused); });
  };
  EXPECT_THAT(plan({}), HasSubstr("known exactly has no covariance"));
  EXPECT_EQ(plan({"scenario.map_sigma_m=0.1"}), "nothing");
}

/// The priors of many runs, as deviations from the truth.
TEST(KnownMap, HasErrorsOfTheStatedSize) {
  const StudyPlan plan =
      make_plan(parsed(kKnownMap, {"scenario.start_sigma_m=2", "scenario.start_sigma_deg=30",
                                   "scenario.map_sigma_m=0.5", "belief.map_sigma_m=0.25",
                                   "scenario.map=random"}),
                {}, ExternalPrograms::refused);
  constexpr int kDrawnRuns = 400;
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  double map = 0.0, n = 0.0;
  for (std::uint64_t run = 0; run < kDrawnRuns; ++run) {
    Drive drive;
    plan.drives->generate(run, drive);
    ASSERT_TRUE(drive.prior.has_value());
    start += boxminus(plan.drives->itinerary().start, drive.prior->pose.mean).cwiseAbs2();
    const std::vector<Eigen::Vector2d> truth = plan.own_landmarks(run);
    ASSERT_EQ(drive.prior->map.size(), truth.size());
    for (std::size_t k = 0; k < truth.size(); ++k) {
      map += (truth[k] - drive.prior->map[k].mean).squaredNorm();
      n += 2.0;
      EXPECT_EQ(drive.prior->map[k].covariance(0, 0), 0.0625);
    }
  }
  const double five_errors = 5.0 * std::sqrt(2.0 / kDrawnRuns);
  EXPECT_NEAR(start(0) / kDrawnRuns / 4.0, 1.0, five_errors);
  EXPECT_NEAR(start(1) / kDrawnRuns / 4.0, 1.0, five_errors);
  EXPECT_NEAR(start(2) / kDrawnRuns / std::pow(kPi / 6.0, 2), 1.0, five_errors);
  EXPECT_NEAR(map / n / 0.25, 1.0, 5.0 * std::sqrt(2.0 / n));
}

class KnownMapVerdict : public testing::Test {
 protected:
  /// Runs a study of filters in a tiny loop with a known map.
  analysis::StudyAnalysis analysed(int runs, const std::vector<std::string>& more) const {
    std::vector<std::string> settings{
        "belief.map=known",          "scenario.noise=matched",
        "scenario.sigma_speed=0.1",  "scenario.sigma_steer_deg=1",
        "scenario.sigma_range=0.05", "scenario.sigma_bearing_deg=1",
        "record.rate=scan",          "study.runs=" + std::to_string(runs)};
    settings.insert(settings.end(), more.begin(), more.end());
    std::string text = analysis::kTinyLoop;
    text.replace(text.find("cell = ekf_slam\n"), 16,
                 "cell = ekf_slam\ncell = riekf_slam\ncell = ukf_slam\n"
                 "cell = fastslam1 particles=200\ncell = fastslam2 particles=200\n");
    analysis::write_studied_result(path_, text, settings);
    return analysis::analyze(ResultFile(path_), 0.95, Parallel::serial(), 1.3);
  }
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
};

TEST_F(KnownMapVerdict, IsThatOfAConsistentFilterWhereItsModelHolds) {
  const auto study = analysed(300, {"scenario.start_sigma_m=0.05", "scenario.start_sigma_deg=1"});
  for (const auto& cell : study.cells) {
    SCOPED_TRACE(cell.label);
    EXPECT_NEAR(cell.over_runs("map_landmarks").mean, 5.0, 1e-9);
    EXPECT_THAT(cell.get<analysis::MapErrors>().missing, HasSubstr("takes it to be exact"));
    if (cell.label == "fastslam1_m200") continue;  // it draws too few particles near the truth
    EXPECT_NEAR(cell.verdict.ratio_estimate(), 1.0, 0.15);
    EXPECT_FALSE(cell.verdict.is_refused);
  }
  EXPECT_TRUE(std::isnan(study.bound.map));
}

TEST_F(KnownMapVerdict, IsNeverConsistentIfTheVehicleIsKidnapped) {
  const auto study = analysed(60, {"scenario.start_sigma_m=10", "scenario.start_sigma_deg=120",
                                   "belief.start_sigma_m=0.01", "belief.start_sigma_deg=0.1"});
  for (const auto& cell : study.cells)
    EXPECT_TRUE(cell.verdict.is_refused || cell.verdict.failed > 0) << cell.label;
}

// With an error of the heading alone, which a motion turns into one along a circle, the invariant
// error is normal and the additive one is not.
TEST_F(KnownMapVerdict, IsBetterForTheInvariantErrorFromAWrongHeading) {
  const auto study = analysed(300, {"scenario.start_sigma_deg=40"});
  const double ekf = study.cells[0].verdict.ratio_estimate();
  const double invariant = study.cells[1].verdict.ratio_estimate();
  EXPECT_GT(ekf, 2.0);
  EXPECT_TRUE(study.cells[0].verdict.is_refused);
  EXPECT_NEAR(invariant, 1.0, 0.1);
}

TEST_F(KnownMapVerdict, CountsTheErrorsOfAnUncertainMap) {
  const auto study = analysed(
      100, {"scenario.map_sigma_m=0.3", "record.columns=pose, covariance, final_map, joint"});
  for (const auto& cell : study.cells) {
    EXPECT_LT(cell.over_runs("landmark_rms").mean, 0.3 * std::sqrt(2.0)) << cell.label;
    EXPECT_EQ(cell.over_runs("landmarks_spurious").mean, 0.0) << cell.label;
    EXPECT_EQ(cell.over_runs("landmarks_missed").mean, 0.0) << cell.label;
  }
  EXPECT_NEAR(study.cells[0].over_runs("landmark_nees").mean, 2.0, 0.5);
}

}  // namespace
}  // namespace montecarta::experiments
