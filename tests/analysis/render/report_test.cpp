// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/report.hpp"

#include "analysis/render/page/html.hpp"
#include "analysis/render/page/page.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/registry.hpp"
#include "analysis/study/section.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/text_table.hpp"
#include "engine/errors.hpp"
#include "tests/analysis/recorded_result.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <algorithm>
#include <fstream>
#include <set>
#include <variant>

namespace montecarta::analysis {
namespace {

TEST(Report, HoldsEverySectionAndNeedsNothingElse) {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 6, 120);
  write_report(ResultFile(folder / "out.h5"), folder / "report");
  const std::string page = text_in(folder / "report/index.html");
  EXPECT_THAT(page, HasSubstr("gain is &lt;not&gt; a number &amp; worse"));
  EXPECT_THAT(page, Not(HasSubstr("record.full_runs = 1")));
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
  EXPECT_TRUE(std::filesystem::exists(folder / "report/data/nees_ratio_pose.csv"));
  const std::string summary = text_in(folder / "report/summary.md");
  for (const char* part : {"## Verdict and accuracy\n\n| cell |", "\n|---|", "](figures/anees.svg)",
                           "gain is \\<not\\> a number"}) {
    EXPECT_THAT(summary, HasSubstr(part));
  }
  EXPECT_THAT(summary, Not(HasSubstr("](figures/rmse.svg)")));
  const std::size_t found = summary.find("\n\nOf 2 cells (a cell is a filter in one setting), "),
                    studied = summary.find(" Each of 2 cells estimates ");
  EXPECT_LT(found, summary.find(" optimistic: "));
  EXPECT_LT(summary.find(" optimistic: "), studied) << "what was found comes first";
  EXPECT_LT(studied, summary.find("](figures/anees.svg)")) << "words come before a figure";
  EXPECT_LT(summary.find("](figures/anees.svg)"), summary.find("\n|")) << "the figure comes first";
  EXPECT_GT(summary.find("\n- study `"), summary.rfind("\n|")) << "the origin comes last";
}

/// The number of times that `part` is in `text`.
std::size_t count_in(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != text.npos; at += part.size()) ++n;
  return n;
}

/// The sections of a page from top to bottom, by their names.
std::vector<std::string> sections_in(const std::string& page) {
  const std::string begin = "<section id=\"";
  std::vector<std::string> names;
  for (std::size_t at = 0; (at = page.find(begin, at)) != page.npos;) {
    at += begin.size();
    names.push_back(page.substr(at, page.find('"', at) - at));
  }
  return names;
}

/// A section of a page as HTML; empty where there is none.
std::string section_in(const std::string& page, const std::string& name) {
  const std::size_t begin = page.find("<section id=\"" + name + "\">");
  return begin == page.npos ? "" : page.substr(begin, page.find("</section>", begin) - begin);
}

bool is_folded(const std::string& section) {
  return section.find("\">\n<details class=\"folded\"><summary><h2>") != section.npos;
}

/// A page as it is read before any "?" is opened.
std::string without_explanations(std::string page) {
  const std::string end = "</details>";
  for (std::size_t at = 0; (at = page.find("<details class=\"why\">", at)) != page.npos;) {
    page.erase(at, page.find(end, at) + end.size() - at);
  }
  return page;
}

TEST(ReadingOrder, PlacesEverySectionAndFigureOnce) {
  std::set<std::string> names;
  std::size_t places = 0;
  for (const SectionPlace& place : reading_order()) {
    names.insert(place.section);
    for (const std::string& figure : place.figures) names.insert("figure " + figure);
    places += 1 + place.figures.size();
  }
  EXPECT_EQ(names.size(), places);
}

class ReportOfTwoCells : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const ScratchFolder folder;
    write_synthetic_result(folder / "out.h5", 6, 120, {}, [](StudyPlan& plan) {
      plan.columns.map = false;
      plan.columns.final_map = false;
    });
    const ResultFile file(folder / "out.h5");
    write_report(file, folder / "report");
    page() = text_in(folder / "report/index.html");
    sections() = sections_of(analyze(file));
  }
  static std::string& page() {
    static std::string text;
    return text;
  }
  static std::vector<Section>& sections() {
    static std::vector<Section> all;
    return all;
  }
};

TEST_F(ReportOfTwoCells, IsReadFromTheVerdictToWhereItComesFrom) {
  const std::vector<std::string> names = sections_in(page());
  const std::vector<std::string> open = {"title", "cards", "nees", "replay", "errors"};
  ASSERT_GT(names.size(), open.size());
  EXPECT_TRUE(std::equal(open.begin(), open.end(), names.begin()));
  EXPECT_EQ(names[open.size()], "verdict");
  EXPECT_EQ(names.back(), "origin");
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
}

TEST_F(ReportOfTwoCells, FoldsEverySectionBehindTheErrorsWithASummary) {
  bool is_behind = false;
  for (const std::string& name : sections_in(page())) {
    const std::string section = section_in(page(), name);
    EXPECT_EQ(is_folded(section), is_behind) << name;
    if (is_behind) {
      EXPECT_THAT(section, Not(HasSubstr("class=\"says\"></span>"))) << name;
      EXPECT_THAT(section, Not(HasSubstr(" -</span></summary>"))) << name;
    }
    is_behind = is_behind || name == "errors";
  }
}

TEST_F(ReportOfTwoCells, HasACardForEveryCell) {
  const std::string cards = section_in(page(), "cards");
  EXPECT_EQ(count_in(cards, "<article class=\"card"), 2u);
  EXPECT_EQ(count_in(cards, "<article class=\"card optimistic\">"), 1u);
  EXPECT_EQ(count_in(cards, "<p class=\"word\">optimistic</p>"), 1u);
  EXPECT_EQ(count_in(cards, "<svg class=\"spark\""), 2u);
  EXPECT_EQ(count_in(cards, "<path class=\"shown\""), 1u);
  EXPECT_EQ(count_in(cards, "<p class=\"sentence\">scripted_m"), 2u);
  EXPECT_EQ(count_in(cards, "<a href=\"#failures\">Runs: 1 FAILED, 5 complete</a>"), 1u);
  EXPECT_THAT(section_in(page(), "failures"), HasSubstr("gain is &lt;not&gt; a number"));
  for (const char* number : {"NEES ratio</span>", "position RMSE [m]", "heading RMSE [deg]"}) {
    EXPECT_EQ(count_in(cards, number), 2u) << number;
  }
  EXPECT_EQ(count_in(cards, "<details class=\"why\">"), 2u * 4 + 1);
}

TEST_F(ReportOfTwoCells, ShowsNoNoteBeforeItIsAskedFor) {
  const std::string shown = without_explanations(page());
  std::size_t notes = 0;
  for (const Section& section : sections()) {
    if (!section.has_content()) continue;
    for (const Section::Block& block : section.blocks) {
      const auto* note = std::get_if<Section::Note>(&block);
      if (note == nullptr) continue;
      ++notes;
      EXPECT_THAT(page(), HasSubstr(html_escape(note->text)));
      EXPECT_THAT(shown, Not(HasSubstr(html_escape(note->text))));
    }
  }
  EXPECT_GT(notes, 5u);
}

TEST_F(ReportOfTwoCells, SaysWhichRunOfHowManyItReplays) {
  EXPECT_THAT(without_explanations(section_in(page(), "replay")), HasSubstr(", one of 6 "));
}

TEST_F(ReportOfTwoCells, NamesWhatIsNotThereInOnePlace) {
  EXPECT_EQ(section_in(page(), "map_errors"), "");
  EXPECT_THAT(section_in(page(), "missing"), HasSubstr("final_map"));
}

TEST_F(ReportOfTwoCells, HasFiguresInTheSectionsOfTheirSubjects) {
  EXPECT_THAT(section_in(page(), "nees"), HasSubstr("id=\"figure_anees\""));
  EXPECT_THAT(section_in(page(), "errors"), HasSubstr("id=\"figure_error_envelopes\""));
  EXPECT_THAT(section_in(page(), "diversity"), HasSubstr("id=\"figure_ancestry\""));
  EXPECT_THAT(section_in(page(), "innovations"), HasSubstr("id=\"figure_whiteness\""));
  const std::vector<std::string> names = sections_in(page());
  EXPECT_LT(std::ranges::find(names, "innovations"), std::ranges::find(names, "diversity"));
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
  const std::vector<std::string> top = {"title", "references", "replay"};
  const std::vector<std::string> names = sections_in(page);
  ASSERT_GT(names.size(), top.size());
  EXPECT_TRUE(std::equal(top.begin(), top.end(), names.begin()));
  EXPECT_FALSE(is_folded(section_in(page, "references")));
  EXPECT_THAT(section_in(page, "references"), HasSubstr("id=\"figure_reference_error\""));
  EXPECT_EQ(section_in(page, "cards"), "");
  EXPECT_THAT(page, HasSubstr("class=\"replay-data\">{\"run\":"));
  EXPECT_THAT(page, HasSubstr("record.full_runs = 1"));
  EXPECT_THAT(page, HasSubstr("its true path is unknown"));
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

TEST(Report, IsNotMadeOfARunThatIsNotThere) {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 2, 40);
  const ResultFile file(folder / "out.h5");
  ReportOptions options;
  options.run = 99;
  EXPECT_THROW(write_report(file, folder / "report", options), StudyError);
  EXPECT_FALSE(std::filesystem::exists(folder / "report/index.html"));
}

}  // namespace
}  // namespace montecarta::analysis
