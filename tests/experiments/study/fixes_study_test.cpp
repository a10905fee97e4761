// SPDX-License-Identifier: BSD-3-Clause
// Fixes of the position in a study, beside the detections of landmarks.
#include "analysis/study/study_analysis.hpp"
#include "engine/records/result_file.hpp"
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

const std::string kWithFixes = with("[cells]", "fixes = position\nsigma_fix = 2\n[cells]");

Drive drive_with(const std::string& text, const std::vector<std::string>& more, std::uint64_t run,
                 Itinerary* itinerary = nullptr) {
  const StudyPlan plan = make_plan(parsed(text, more), {}, ExternalPrograms::refused);
  Drive drive;
  plan.drives->generate(run, drive);
  if (itinerary != nullptr) *itinerary = plan.drives->itinerary();
  return drive;
}

TEST(Fixes, AreNoPartOfTheTextOfAStudyWithoutThem) {
  const Study study = parsed(kGoodStudy), with_fixes = parsed(kWithFixes);
  EXPECT_EQ(resolved_text(parsed(kGoodStudy, {"scenario.fixes=none"})), resolved_text(study));
  EXPECT_EQ(resolved_text(parsed(resolved_text(with_fixes))), resolved_text(with_fixes));
  const std::map<std::string, std::string> of_fixes = {{"scenario.fixes", "position"},
                                                       {"scenario.fix_rate", "1"},
                                                       {"scenario.sigma_fix", "2"},
                                                       {"belief.sigma_fix", "2"}};
  for (const auto& [key, value] : of_fixes) {
    EXPECT_FALSE(resolved_settings(study).contains(key)) << key;
    EXPECT_EQ(resolved_settings(with_fixes).at(key), value) << key;
  }
}

TEST(Fixes, AreRefusedWithAFilterThatTakesNone) {
  for (const char* cell :
       {"smoother", "fixed_lag_smoother", "ampf_de", "fej_ekf_slam", "dead_reckoning"}) {
    EXPECT_THAT(complaint(kWithFixes, {"cells.cell=" + std::string(cell)}),
                AllOf(HasSubstr(std::string(cell) + " with scenario.fixes = position"),
                      HasSubstr("use one of ekf_slam, riekf_slam, ukf_slam, right_ukf_slam, "
                                "left_ukf_slam, fastslam1")));
  }
  EXPECT_EQ(complaint(kWithFixes, {"cells.cell=ukf_slam"}), "nothing");
}

TEST(Fixes, NeedARateThatDividesTheScans) {
  const auto planned = [](const std::string& rate) {
    return complaint_of([&] { drive_with(kWithFixes, {"scenario.fix_rate=" + rate}, 0); });
  };
  EXPECT_EQ(planned("2.5"), "nothing");
  EXPECT_THAT(planned("2"), HasSubstr("fix_rate does not divide scan_rate (2.5 scans a fix)"));
  EXPECT_THAT(planned("10"), HasSubstr("fix_rate does not divide scan_rate"));
  EXPECT_THAT(complaint(kGoodStudy, {"scenario.fix_rate=1"}),
              HasSubstr("fix_rate does not apply to scenario.fixes = none"));
  EXPECT_THAT(complaint(kGoodStudy, {"belief.sigma_fix=1"}),
              HasSubstr("sigma_fix does not apply to scenario.fixes = none"));
}

/// Detections and motion are those of the study without fixes.
TEST(Fixes, HaveTheStatedErrorsAndTimesAndChangeNothingElse) {
  double squares = 0.0, n = 0.0;
  for (const char* noise : {"matched", "measured-control"}) {
    const std::string matched = "scenario.noise=" + std::string(noise);
    for (std::uint64_t run = 0; run < 3; ++run) {
      Itinerary itinerary;
      const Drive fixed = drive_with(kWithFixes, {matched}, run, &itinerary);
      const Drive plain = drive_with(kGoodStudy, {matched}, run);
      ASSERT_EQ(fixed.detections.size(), plain.detections.size());
      for (std::size_t k = 0; k < plain.detections.size(); ++k)
        ASSERT_EQ(fixed.detections[k].values, plain.detections[k].values);
      EXPECT_FALSE(plain.fix(4).has_value());
      for (std::size_t s = 0; s < itinerary.scans(); ++s) {
        ASSERT_EQ(fixed.fix(s).has_value(), s % 5 == 4) << "scan " << s;
        if (!fixed.fix(s)) continue;
        squares += (*fixed.fix(s) - place_of(fixed.truth[itinerary.scan_step[s]])).squaredNorm();
        n += 2.0;
      }
    }
  }
  EXPECT_NEAR(squares / n / 4.0, 1.0, 5.0 * std::sqrt(2.0 / n));
}

class FixesVerdict : public testing::Test {
 protected:
  analysis::StudyAnalysis analysed(const std::vector<std::string>& more) const {
    std::vector<std::string> settings{
        "scenario.noise=matched",     "scenario.fixes=position",
        "scenario.fix_rate=2.5",      "scenario.sigma_speed=0.2",
        "scenario.sigma_steer_deg=2", "scenario.sigma_fix=0.3",
        "scenario.sigma_range=0.05",  "scenario.sigma_bearing_deg=0.5",
        "record.rate=scan",           "study.runs=300"};
    for (const std::string& one : more) {
      std::erase_if(settings, [key = one.substr(0, one.find('=') + 1)](const std::string& old) {
        return old.starts_with(key);
      });
      settings.push_back(one);
    }
    std::string text = analysis::kTinyLoop;
    text.replace(text.find("cell = ekf_slam\n"), 16,
                 "cell = ekf_slam\ncell = riekf_slam\ncell = ukf_slam\n");
    analysis::write_studied_result(path_, text, settings);
    return analysis::analyze(ResultFile(path_), 0.95, Parallel::serial(), 1.3);
  }
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
};

TEST_F(FixesVerdict, IsThatOfAConsistentFilterWhereItsModelHolds) {
  const auto study = analysed({});
  for (const auto& cell : study.cells) {
    SCOPED_TRACE(cell.label);
    EXPECT_NEAR(cell.verdict.ratio_estimate(), 1.0, 0.15);
    EXPECT_FALSE(cell.verdict.is_refused);
  }
}

TEST_F(FixesVerdict, IsOptimisticWhereTheDeviationIsHalved) {
  const auto study = analysed({"belief.sigma_fix=0.15"});
  for (const auto& cell : study.cells) {
    EXPECT_GT(cell.verdict.ratio_estimate(), 1.3) << cell.label;
    EXPECT_TRUE(cell.verdict.is_refused) << cell.label;
  }
}

/// In a known map the errors of a filter are those of the bound, with and without fixes.
TEST_F(FixesVerdict, HasTheBoundOfAFilterWithFixes) {
  const std::vector<std::string> known{"belief.map=known", "scenario.start_sigma_m=0.1",
                                       "scenario.noise=measured-control",
                                       "scenario.sigma_bearing_deg=5", "scenario.sigma_range=1"};
  const auto fixed = analysed(known);
  std::vector<std::string> without = known;
  without.push_back("scenario.sigma_fix=1000");
  const auto worthless = analysed(without);
  EXPECT_LT(fixed.bound.position.back(), 0.8 * worthless.bound.position.back());
  const double rmse = fixed.cells[0].over_runs("position_rmse").mean;
  double squares = 0.0;
  for (const double position : fixed.bound.position) squares += position * position;
  EXPECT_NEAR(rmse / std::sqrt(squares / static_cast<double>(fixed.bound.position.size())), 1.0,
              0.1);
}

}  // namespace
}  // namespace montecarta::experiments
