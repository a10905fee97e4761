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
                 {"--truth", "truth.txt", "--error", error, "-o", "mine.h5", "--force"});
    words.insert(words.end(), more.begin(), more.end());
    return call(words);
  }
  void write_open_vins() const {
    write("e_0.txt", "1 0.3 0 0 0 0 0 1 0.01 0 0 0.01 0 0.01 0.09 0 0 0.09 0 0.09\n");
    write("e_1.txt", "1 0 0.6 0 0 0 0 1 0.01 0 0 0.01 0 0.01 0.09 0 0 0.09 0 0.09\n");
    write("truth.txt", "# timestamp tx ty tz qx qy qz qw\n1 0 0 0 0 0 0 1\n");
  }
};

TEST_F(JudgeLayouts, OpenVinsIsOfTheErrorWorldAndSaysWhatItLacks) {
  write_open_vins();
  const Called called = judge({"e_0.txt", "e_1.txt"}, "world");
  ASSERT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out, HasSubstr("no covariance between position and rotation"));
  const auto study = analysis::analyze(ResultFile(folder_ / "mine.h5"));
  EXPECT_NEAR(study.cells[0].consistency().mean, 2.5, 1e-12);
  EXPECT_TRUE(study.imported.lacks_cross_terms);
  EXPECT_FALSE(ResultFile(folder_ / "mine.h5").cells()[0].has("nees_body")) << "nothing to hint at";
  EXPECT_THAT(judge({"e_0.txt", "e_1.txt"}, "body").err, HasSubstr("not of OpenVINS' layout"));
}

// The same estimates are another study with other innovations beside, and with other covariances.
TEST_F(JudgeLayouts, WhatLiesBesideIsJudgedAndPartOfTheStudy) {
  write_open_vins();
  std::filesystem::create_directory(folder_ / "run_0");
  std::filesystem::create_directory(folder_ / "run_1");
  for (const char* run : {"0", "1"}) {
    const std::string to = "run_" + std::string(run);
    write(to + "/estimate.txt", text_of("e_" + std::string(run) + ".txt"));
    write(to + "/innovation.csv", "time_s,nis,nis_dof\n1,6,2\n");
  }
  const std::vector<std::string> files = {"run_0/estimate.txt", "run_1/estimate.txt"};
  ASSERT_EQ(judge(files, "world").code, 0);
  const ResultFile file(folder_ / "mine.h5");
  const auto numbers = numbers_of(analysis::analyze(file).cells[0]);
  const auto nis = std::ranges::find(numbers, "nis_per_component", &analysis::NamedNumber::name);
  EXPECT_NEAR(nis->value, 3.0, 1e-12);
  write("run_1/innovation.csv", "time_s,nis,nis_dof\n1,5,2\n");
  ASSERT_EQ(judge(files, "world").code, 0);
  EXPECT_NE(ResultFile(folder_ / "mine.h5").study_sha256(), file.study_sha256());
  std::filesystem::remove(folder_ / "run_1/innovation.csv");
  EXPECT_THAT(judge(files, "world").err, HasSubstr("estimate.txt: no nis"));
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
  write("truth.txt", "time_s,x_m,y_m,heading_rad\n1,0,0,1.4707963267948966\n");
  ASSERT_EQ(judge(files, "world").code, 0);
  const auto is_hint = AllOf(HasSubstr("Hint, no verdict: "), HasSubstr("body (ANEES 3"));
  EXPECT_THAT(call({"analyze", "mine.h5"}).out, is_hint);
  ASSERT_EQ(call({"report", "mine.h5", "-o", "page"}).code, 0);
  EXPECT_THAT(text_of("page/index.html"), HasSubstr("Hint, no verdict: "));
  EXPECT_EQ(call({"gate", "mine.h5", "--cell", "e"}).code, 4) << "a hint is no verdict";
}

TEST_F(JudgeLayouts, TheMarginIsStored) {
  write_open_vins();
  ASSERT_EQ(judge({"e_0.txt", "e_1.txt"}, "world", {"--within", "1.7"}).code, 0);
  EXPECT_EQ(analysis::analyze(ResultFile(folder_ / "mine.h5")).within, 1.7);
  ASSERT_EQ(judge({"e_0.txt", "e_1.txt"}, "world").code, 0);
  EXPECT_EQ(analysis::analyze(ResultFile(folder_ / "mine.h5")).within, analysis::kUsualMargin);
}

TEST_F(JudgeLayouts, TwoComponentsOfOneNameAreToldApart) {
  write("e_0.csv", "time_s,v_m,v_rad,cov_0_0,cov_0_1,cov_1_1\n1,1,1,1,0,1\n");
  write("truth.txt", "time_s,v_m,v_rad\n1,1,1\n");
  EXPECT_THAT(judge({"e_0.csv"}, "world").err,
              AllOf(HasSubstr("e_0.csv:1: 'v_m' and 'v_rad' are both of a component v"),
                    HasSubstr("name them apart")));
}

}  // namespace
}  // namespace montecarta::experiments
