// SPDX-License-Identifier: BSD-3-Clause
// What 'montecarta judge' reads besides one CSV file a run, and what the file keeps of it.
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "engine/records/result_file.hpp"
#include "tests/experiments/commands/program.hpp"

#include <gmock/gmock.h>

#include <algorithm>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class JudgeLayouts : public Program {
 protected:
  Called judge(const std::vector<std::string>& files, const std::string& error,
               const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"judge"};
    words.insert(words.end(), files.begin(), files.end());
    words.insert(words.end(),
                 {"--truth", "truth.csv", "--error", error, "-o", "mine.h5", "--force"});
    words.insert(words.end(), more.begin(), more.end());
    return call(words);
  }
  /// Two estimates and their truth.
  void write_estimates() const {
    const std::string header = "time_s,x_m,y_m,cov_0_0,cov_0_1,cov_1_1\n";
    write("e_0.csv", header + "1,0.3,0,0.01,0,0.09\n");
    write("e_1.csv", header + "1,0,0.6,0.01,0,0.09\n");
    write("truth.csv", "time_s,x_m,y_m\n1,0,0\n");
  }
};

TEST_F(JudgeLayouts, ATrajectoryIsSentToItsConverter) {
  write("e_0.txt", "# timestamp tx ty tz qx qy qz qw\n1 0.3 0 0 0 0 0 1\n");
  write("truth.csv", "time_s,x_m,y_m\n1,0,0\n");
  EXPECT_THAT(judge({"e_0.txt"}, "world").err,
              AllOf(HasSubstr("e_0.txt:2"), HasSubstr("convert/trajectory.py")));
}

// The same estimates are another study with other innovations beside.
TEST_F(JudgeLayouts, WhatLiesBesideIsJudgedAndPartOfTheStudy) {
  write_estimates();
  std::filesystem::create_directory(folder_ / "run_0");
  std::filesystem::create_directory(folder_ / "run_1");
  for (const char* run : {"0", "1"}) {
    const std::string to = "run_" + std::string(run);
    write(to + "/estimate.csv", text_of("e_" + std::string(run) + ".csv"));
    write(to + "/innovation.csv", "time_s,nis,nis_dof\n1,6,2\n");
  }
  const std::vector<std::string> files = {"run_0/estimate.csv", "run_1/estimate.csv"};
  ASSERT_EQ(judge(files, "world").code, 0);
  const ResultFile file(folder_ / "mine.h5");
  const auto numbers = numbers_of(analysis::analyze(file).cells[0]);
  const auto nis = std::ranges::find(numbers, "nis_per_component", &analysis::NamedNumber::name);
  EXPECT_NEAR(nis->value, 3.0, 1e-12);
  write("run_1/innovation.csv", "time_s,nis,nis_dof\n1,5,2\n");
  ASSERT_EQ(judge(files, "world").code, 0);
  EXPECT_NE(ResultFile(folder_ / "mine.h5").study_sha256(), file.study_sha256());
  std::filesystem::remove(folder_ / "run_1/innovation.csv");
  EXPECT_THAT(judge(files, "world").err, HasSubstr("estimate.csv: no nis"));
}

TEST_F(JudgeLayouts, TheHintIsSaidByAnalyzeAndReportFromTheFileAlone) {
  std::string P = ",0.01,0,0,0,1,0,0,0,0.01\n", header = "time_s,x_m,y_m,heading_rad";
  for (int k = 0; k < 9; ++k)
    header += ",cov_" + std::to_string(k / 3) + "_" + std::to_string(k % 3);
  // Headed along y, the small deviation is across in the frame of the body.
  std::vector<std::string> files;
  for (int run = 0; run < 20; ++run) {
    const double e = run % 2 == 0 ? 1.0 : -1.0;
    files.push_back("e_" + std::to_string(run) + ".csv");
    write(files.back(), header + "\n1," + std::to_string(-e) + "," + std::to_string(0.1 * e) +
                            ",1.5707963267948966" + P);
  }
  write("truth.csv", "time_s,x_m,y_m,heading_rad\n1,0,0,1.4707963267948966\n");
  ASSERT_EQ(judge(files, "world").code, 0);
  const auto is_hint = AllOf(HasSubstr("Hint, no verdict: "), HasSubstr("body (ANEES 3"));
  EXPECT_THAT(call({"analyze", "mine.h5"}).out, is_hint);
  ASSERT_EQ(call({"report", "mine.h5", "-o", "page"}).code, 0);
  EXPECT_THAT(text_of("page/index.html"), HasSubstr("Hint, no verdict: "));
  EXPECT_EQ(call({"gate", "mine.h5", "--cell", "e"}).code, 4) << "a hint is no verdict";
}

TEST_F(JudgeLayouts, TheMarginIsStored) {
  write_estimates();
  ASSERT_EQ(judge({"e_0.csv", "e_1.csv"}, "world", {"--within", "1.7"}).code, 0);
  EXPECT_EQ(analysis::analyze(ResultFile(folder_ / "mine.h5")).within, 1.7);
  ASSERT_EQ(judge({"e_0.csv", "e_1.csv"}, "world").code, 0);
  EXPECT_EQ(analysis::analyze(ResultFile(folder_ / "mine.h5")).within, analysis::kUsualMargin);
}

TEST_F(JudgeLayouts, TwoComponentsOfOneNameAreToldApart) {
  write("e_0.csv", "time_s,v_m,v_rad,cov_0_0,cov_0_1,cov_1_1\n1,1,1,1,0,1\n");
  write("truth.csv", "time_s,v_m,v_rad\n1,1,1\n");
  EXPECT_THAT(judge({"e_0.csv"}, "world").err,
              AllOf(HasSubstr("e_0.csv:1: 'v_m' and 'v_rad' are both of a component v"),
                    HasSubstr("name them apart")));
}

}  // namespace
}  // namespace montecarta::experiments
