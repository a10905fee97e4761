// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/report.hpp"

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/page/page.hpp"
#include "engine/errors.hpp"
#include "tests/analysis/recorded_result.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace montecarta::analysis {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Report, HoldsEverySectionAndNeedsNothingElse) {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 6, 120);
  write_report(ResultFile(folder / "out.h5"), folder / "report");
  const std::string page = text_in(folder / "report/index.html");
  EXPECT_THAT(page, HasSubstr("gain is &lt;not&gt; a number &amp; worse"));
  EXPECT_LT(page.find("<h2>Verdict"), page.find("<h2>Failed runs"));
  EXPECT_LT(page.find("<h2>Failed runs"), page.find("<h2>What happened"));
  EXPECT_THAT(page, Not(HasSubstr("to record.columns of the study")));
  EXPECT_THAT(page, Not(HasSubstr("src=")));
  EXPECT_THAT(page, Not(HasSubstr("href=\"http")));
  for (const std::string name :
       {"paths", "anees", "anees_parts", "rmse", "diversity", "ess", "ancestry", "whiteness"}) {
    const auto figure = folder / ("report/figures/" + name);
    EXPECT_THAT(text_in(figure.string() + ".svg"), HasSubstr("</svg>")) << name;
    EXPECT_THAT(text_in(figure.string() + ".pdf"), testing::StartsWith("%PDF")) << name;
    EXPECT_THAT(page, HasSubstr("figures/" + name + ".pdf"));
  }
  EXPECT_THAT(text_in(folder / "report/tables/verdict.tex"), HasSubstr("\\bottomrule"));
  EXPECT_TRUE(std::filesystem::exists(folder / "report/data/anees_pose.csv"));
  const std::string summary = text_in(folder / "report/summary.md");
  for (const char* part : {"## Verdict and accuracy\n\n| cell |", "\n|---|", "](figures/anees.svg)",
                           "gain is \\<not\\> a number"}) {
    EXPECT_THAT(summary, HasSubstr(part));
  }
  EXPECT_THAT(summary, Not(HasSubstr("](figures/rmse.svg)")));
}

TEST(Markdown, ManyRowsAreCounted) {
  TextTable table{{{"cell", Align::left}, {"a|b"}}, {}};
  table.rows.assign(63, {"x", "1"});
  const std::string markdown = markdown_table(table);
  EXPECT_THAT(markdown, testing::StartsWith("| cell | a\\|b |\n|---|---:|\n| x | 1 |\n"));
  EXPECT_THAT(markdown, testing::EndsWith("| x | 1 |\n\n... and 3 rows more\n"));
}

TEST(Report, JudgesARecordedDriveByItsReferences) {
  const ScratchFolder folder;
  write_recorded_result(folder / "out.h5", 4, 400);
  write_report(ResultFile(folder / "out.h5"), folder / "report");
  const std::string page = text_in(folder / "report/index.html");
  EXPECT_THAT(page, HasSubstr("<h2>Judged by references"));
  EXPECT_THAT(page, Not(HasSubstr("<h2>Verdict")));
  EXPECT_THAT(page, HasSubstr("class=\"replay-data\">{\"run\":"));
  EXPECT_THAT(page, HasSubstr("' to record.columns of the study"));
  EXPECT_THAT(page, HasSubstr("nobody knows its true path"));
  for (const char* name :
       {"figures/paths.svg", "figures/reference_error.svg", "figures/map_size.svg",
        "tables/reference.tex", "tables/baseline.tex", "tables/map.tex", "tables/references.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "report" / name)) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "report/figures/rmse.svg"));
  EXPECT_FALSE(std::filesystem::exists(folder / "report/tables/verdict.tex"));
  const std::string paths = text_in(folder / "report/figures/paths.gp");
  EXPECT_THAT(paths, HasSubstr("title 'fix'"));
  EXPECT_THAT(paths, Not(HasSubstr("true path")));
  EXPECT_THAT(text_in(folder / "report/data/map_ekf_slam.csv"), HasSubstr("\n20.3,5,"));
}

/// A filter that has a mixture and no particles, and a filter of a few weighted hypotheses that
/// have no ancestry to speak of.
TEST(Report, KnowsMixturesWithoutParticlesAndWithFew) {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 4, 120, {}, [](StudyPlan& plan) {
    plan.cells[0].particles = 0;
    plan.columns.ancestry = false;
  });
  const StudyAnalysis study = analyze(ResultFile(folder / "out.h5"));
  EXPECT_EQ(study.cells[0].leading, Moments::mixture);
  EXPECT_NE(study.cells[0].verdict.answer, Answer::untested);
  EXPECT_EQ(study.cells[0].find_nees(ErrorBlock::pose, Moments::corrected), nullptr);
  EXPECT_TRUE(study.cells[0].over_time("ess").empty());
  EXPECT_TRUE(study.cells[1].over_time("ancestors_at_start").empty());
  EXPECT_FALSE(study.cells[1].over_time("ess").empty());
}

TEST(Report, IsNotOverwrittenUnaskedNorMadeOfARunThatIsNotThere) {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 2, 40);
  const ResultFile file(folder / "out.h5");
  ReportOptions options;
  options.run = 99;
  EXPECT_THROW(write_report(file, folder / "report", options), StudyError);
  EXPECT_FALSE(std::filesystem::exists(folder / "report/index.html"));
  std::filesystem::create_directories(folder / "report");
  std::ofstream(folder / "report/index.html") << "mine";
  EXPECT_THROW(write_report(file, folder / "report"), StudyError);
  EXPECT_EQ(text_in(folder / "report/index.html"), "mine");
}

}  // namespace
}  // namespace montecarta::analysis
