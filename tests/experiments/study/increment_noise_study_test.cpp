// SPDX-License-Identifier: BSD-3-Clause
// Noise of a step besides that of its controls, in studies.
#include "analysis/study/study_analysis.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/study/make_plan.hpp"
#include "tests/analysis/studied_result.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <string>
#include <vector>

namespace montecarta::experiments {
namespace {

const std::string kAdditive = with("[cells]",
                                   "noise = matched\nincrement_noise = additive\n"
                                   "sigma_increment_left = 0.02\n[cells]");

TEST(IncrementNoise, IsNoPartOfTheTextOfAStudyWithoutIt) {
  for (const char* noise : {"matched", "measured-control"}) {
    const auto settings =
        resolved_settings(parsed(kGoodStudy, {"scenario.noise=" + std::string(noise)}));
    for (const char* section : {"scenario.", "belief."}) {
      for (const char* key : {"increment_noise", "sigma_increment_left", "odometry_alpha_1"}) {
        EXPECT_FALSE(settings.contains(std::string(section) + key)) << section << key;
      }
    }
  }
}

/// A belief without noise must not follow the scenario when the text is read again.
TEST(IncrementNoise, HasATextThatIsTheSameStudy) {
  for (const char* believed : {"none", "additive", "odometry"}) {
    const Study study = parsed(kAdditive, {"belief.increment_noise=" + std::string(believed)});
    EXPECT_EQ(resolved_text(parsed(resolved_text(study))), resolved_text(study));
    EXPECT_EQ(resolved_settings(study).at("belief.increment_noise"), believed);
  }
  const Study study = parsed(kGoodStudy, {"belief.increment_noise=odometry"});
  EXPECT_EQ(resolved_text(parsed(resolved_text(study))), resolved_text(study));
  EXPECT_EQ(resolved_settings(study).at("belief.increment_noise"), "odometry");
  EXPECT_EQ(resolved_settings(study).at("belief.odometry_alpha_1"), "0");
}

TEST(IncrementNoise, NeedsAVehicleThatMayStray) {
  EXPECT_THAT(complaint(kGoodStudy, {"scenario.increment_noise=additive"}),
              HasSubstr("increment_noise does not apply to scenario.noise = measured-control"));
  EXPECT_THAT(complaint(kGoodStudy, {"scenario.sigma_increment_left=1"}),
              HasSubstr("sigma_increment_left does not apply to scenario.noise = "
                        "measured-control"));
  EXPECT_THAT(complaint(kAdditive, {"scenario.odometry_alpha_1=1"}),
              HasSubstr("odometry_alpha_1 does not apply to scenario.increment_noise = additive"));
}

class IncrementVerdict : public testing::Test {
 protected:
  analysis::StudyAnalysis analysed(const std::vector<std::string>& more) const {
    std::vector<std::string> settings{"scenario.noise=matched",
                                      "scenario.vehicle=differential_drive",
                                      "scenario.sigma_speed=0",
                                      "scenario.sigma_yaw_rate_deg=0",
                                      "scenario.sigma_range=0.05",
                                      "scenario.sigma_bearing_deg=1",
                                      "belief.map=known",
                                      "record.rate=scan",
                                      "study.runs=200"};
    settings.insert(settings.end(), more.begin(), more.end());
    std::string text = analysis::kTinyLoop;
    for (const char* line : {"wheelbase = 1\n", "steer_rate_limit_deg = 90\n"})
      text.erase(text.find(line), std::string(line).size());
    text.replace(text.find("cell = ekf_slam\n"), 16,
                 "cell = ekf_slam\ncell = riekf_slam\ncell = ukf_slam motion=linearised\n"
                 "cell = ekf_slam label=quadrature motion=quadrature\n"
                 "cell = ufastslam particles=100\n");
    analysis::write_studied_result(path_, text, settings);
    return analysis::analyze(ResultFile(path_), 0.95, Parallel::serial(), 1.3);
  }
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
};

const std::vector<std::vector<std::string>> kIncrementModels = {
    {"scenario.increment_noise=additive", "scenario.sigma_increment_forward=0.05",
     "scenario.sigma_increment_left=0.03", "scenario.sigma_increment_heading_deg=2"},
    {"scenario.increment_noise=odometry", "scenario.odometry_alpha_1=0.5",
     "scenario.odometry_alpha_2=0.02", "scenario.odometry_alpha_3=0.01",
     "scenario.odometry_alpha_4=0.1"}};

TEST_F(IncrementVerdict, IsThatOfAConsistentFilterWhereItsModelHolds) {
  for (const std::vector<std::string>& model : kIncrementModels) {
    const auto study = analysed(model);
    for (const auto& cell : study.cells) {
      SCOPED_TRACE(model[0] + ", " + cell.label);
      EXPECT_NEAR(cell.verdict.ratio_estimate(), 1.0, 0.15);
      EXPECT_FALSE(cell.verdict.is_refused);
    }
    EXPECT_GT(study.bound.position.back(), 0.0);
  }
}

TEST_F(IncrementVerdict, IsOptimisticWhereItIsBelievedToBeHalf) {
  for (std::vector<std::string> model : kIncrementModels) {
    for (std::size_t k = 1, n = model.size(); k < n; ++k) {
      const auto value = model[k].find('=');
      const double factor = model[0].ends_with("additive") ? 0.25 : 0.0625;
      model.push_back("belief" + model[k].substr(8, value - 7) +
                      std::to_string(factor * std::stod(model[k].substr(value + 1))));
    }
    for (const auto& cell : analysed(model).cells) EXPECT_TRUE(cell.verdict.is_refused);
  }
}

}  // namespace
}  // namespace montecarta::experiments
