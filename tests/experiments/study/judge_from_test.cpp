// SPDX-License-Identifier: BSD-3-Clause
// study.judge_from: scans before that time are not judged.
#include "analysis/run/run_reader.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/study/make_plan.hpp"
#include "tests/analysis/studied_result.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <string>
#include <vector>

namespace montecarta::experiments {
namespace {

using analysis::JudgedScans;
using analysis::StudyAnalysis;

TEST(JudgeFrom, IsNoPartOfTheTextOfAStudyWithoutIt) {
  const std::string text = resolved_text(parsed(kGoodStudy));
  EXPECT_FALSE(resolved_settings(parsed(kGoodStudy)).contains("study.judge_from"));
  EXPECT_EQ(resolved_text(parsed(kGoodStudy, {"study.judge_from=0"})), text);
  const auto later = resolved_settings(parsed(kGoodStudy, {"study.judge_from=2.5"}));
  EXPECT_EQ(later.at("study.judge_from"), "2.5");
}

TEST(JudgeFrom, IsRefusedBehindTheLastScan) {
  const auto plan_from = [](const std::string& time) {
    return complaint_of([&] {
      make_plan(parsed(kGoodStudy, {"study.judge_from=" + time}), {}, ExternalPrograms::refused);
    });
  };
  EXPECT_EQ(plan_from("0.1"), "nothing");
  EXPECT_THAT(plan_from("1e6"), AllOf(HasSubstr("judge_from = 1e+06 (s; the last scan is at "),
                                      HasSubstr("give an earlier time")));
}

class JudgedFrom : public testing::Test {
 protected:
  /// The analysis of a study that begins lost and is judged from a time on.
  StudyAnalysis analysed(const std::string& from, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> settings{"study.judge_from=" + from,
                                      "study.runs=40",
                                      "belief.map=known",
                                      "scenario.noise=matched",
                                      "scenario.start_sigma_deg=60",
                                      "scenario.start_sigma_m=1",
                                      "scenario.sigma_speed=0.1",
                                      "scenario.sigma_steer_deg=1",
                                      "scenario.map_sigma_m=0.1",
                                      "record.columns=pose, covariance, map, joint",
                                      "record.rate=scan"};
    for (const std::string& one : more) {
      std::erase_if(settings, [key = one.substr(0, one.find('=') + 1)](const std::string& old) {
        return old.starts_with(key);
      });
      settings.push_back(one);
    }
    analysis::write_studied_result(path_, analysis::kTinyLoop, settings);
    return analysis::analyze(ResultFile(path_));
  }
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
};

/// The last `kept` values.
std::vector<double> tail_of(const std::vector<double>& values, std::size_t kept) {
  return {values.end() - static_cast<std::ptrdiff_t>(kept), values.end()};
}

TEST_F(JudgedFrom, HasTheNumbersOfTheLaterScansAlone) {
  const StudyAnalysis all = analysed("0"), late = analysed("5");
  const std::size_t kept = late.times.size();
  ASSERT_LT(kept, all.times.size());
  EXPECT_EQ(late.times, tail_of(all.times, kept));
  EXPECT_GE(late.times.front(), 5.0);
  EXPECT_LT(all.times[all.times.size() - kept - 1], 5.0);
  EXPECT_EQ(late.judged.first, all.times.size() - kept);
  EXPECT_EQ(late.bound.position, tail_of(all.bound.position, kept));
  EXPECT_EQ(late.bound.map, all.bound.map);
  const auto& nees = all.cells[0].nees.front();
  EXPECT_EQ(late.cells[0].nees.front().series.average, tail_of(nees.series.average, kept));
  EXPECT_EQ(late.cells[0].over_runs("landmark_rms").mean,
            all.cells[0].over_runs("landmark_rms").mean);
  EXPECT_EQ(late.cells[0].over_runs("landmarks_missed").mean,
            all.cells[0].over_runs("landmarks_missed").mean);
  ASSERT_LT(late.joint_times.size(), all.joint_times.size());
  EXPECT_EQ(late.joint_times, tail_of(all.joint_times, late.joint_times.size()));
}

/// The start is ten times as far off as the filter believes, until detections correct it.
TEST_F(JudgedFrom, AcceptsAFilterThatConverges) {
  const std::vector<std::string> wrong{
      "record.rate=scan",         "scenario.start_sigma_deg=0", "scenario.map_sigma_m=0",
      "scenario.start_sigma_m=2", "belief.start_sigma_m=0.2",   "record.columns=pose, covariance"};
  EXPECT_TRUE(analysed("0", wrong).cells[0].verdict.is_refused);
  const StudyAnalysis late = analysed("14", wrong);
  EXPECT_FALSE(late.cells[0].verdict.is_refused);
  EXPECT_LT(late.cells[0].verdict.ratio_estimate(), 1.3);
}

TEST_F(JudgedFrom, IsSaidWithTheNumberOfScans) {
  EXPECT_THAT(analysed("5").scans_text(), HasSubstr(" scans each, judged from 5 s on ("));
  EXPECT_THAT(analysed("0").scans_text(), Not(HasSubstr("judged")));
}

/// Figures of one run show all of it.
TEST_F(JudgedFrom, LeavesThePictureOfOneRunWhole) {
  const StudyAnalysis late = analysed("5");
  const ResultFile file(path_);
  const std::size_t scans = file.scan_times().size();
  EXPECT_EQ(analysis::read_run(file, file.cells()[0], 0).truth.size(), 3 * scans);
  analysis::RunRows rows;
  analysis::RunReader(file, file.cells()[0]).read(0, rows);
  EXPECT_EQ(rows.truth.size(), 3 * late.times.size());
  EXPECT_EQ(rows.earlier_truth.size(), 3 * late.judged.first);
}

/// The same scans are judged, whichever rows are stored.
TEST_F(JudgedFrom, IsTheSameFromPosesAtControlSteps) {
  const StudyAnalysis scans = analysed("5"), steps = analysed("5", {"record.rate=control"});
  EXPECT_EQ(steps.cells[0].verdict.ratio_estimate(), scans.cells[0].verdict.ratio_estimate());
  EXPECT_EQ(steps.cells[0].over_runs("position_rmse").mean,
            scans.cells[0].over_runs("position_rmse").mean);
}

}  // namespace
}  // namespace montecarta::experiments
