// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/page/html.hpp"

#include "analysis/study/figure.hpp"
#include "analysis/study/strips.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace montecarta::analysis {
namespace {

using testing::HasSubstr;

TEST(Html, EscapesText) {
  EXPECT_EQ(html_escape("a < b & \"c\" 3 +- 1"), "a &lt; b &amp; &quot;c&quot; 3 &plusmn; 1");
}

TEST(Html, ColoursATextByItsToneAndNotByItsWords) {
  const auto row = [](const std::string& text, Tone tone) {
    TextTable table;
    table.add({{"verdict", text, Align::left, tone}});
    return html_table(table);
  };
  EXPECT_THAT(row("consistent within 1.1", Tone::good), HasSubstr("good\">consistent"));
  EXPECT_THAT(row("optimistic", Tone::bad), HasSubstr("bad\">optimistic"));
  EXPECT_THAT(row("optimistic", Tone::plain), HasSubstr("<td>optimistic"));
  EXPECT_THAT(row("undecided: 12 more runs decide", Tone::plain), HasSubstr("\"long\">undecided"));
}

TEST(Html, GivesEveryDrawingItsOwnIdentifiersAndTheColourOfTheText) {
  const std::string svg =
      "<?xml?><svg><g id=\"a\" fill='rgb(  0,   0,   0)'/><use href='#a'/></svg>";
  EXPECT_EQ(inline_svg(svg, "rmse", "what"),
            "<svg class=\"drawing\" role=\"img\" aria-label=\"what\"><g id=\"rmse_a\" "
            "fill='currentColor'/><use "
            "href='#rmse_a'/></svg>");
}

TEST(Html, ExplainsBehindAQuestionMark) {
  EXPECT_EQ(html_explained("<b>1.2</b>", ""), "<b>1.2</b>");
  EXPECT_EQ(html_explained("<b>1.2</b>", html_paragraphs({"1 < 2"})),
            "<details class=\"why\"><summary><b>1.2</b> <span class=\"ask\">?</span></summary>\n"
            "<p>1 &lt; 2</p>\n</details>\n");
}

TEST(Html, ForbidsTheBrowserToAskTheNetwork) {
  EXPECT_THAT(html_page("title", "body"), testing::HasSubstr("content=\"default-src 'none';"));
}

TEST(Json, RoundsNumbersToWhatIsSeenAndSaysWhatIsNone) {
  const std::vector<double> numbers = {1, 0.1 + 0.2, 123456.7, 1e-9, NAN, HUGE_VAL, -HUGE_VAL};
  EXPECT_EQ(script_text(rounded(numbers)), R"([1,0.3,123460.0,1e-09,null,"+inf","-inf"])");
  EXPECT_EQ(script_text(rounded(0.123456, 2)), "0.12");
}

TEST(Json, TextCannotEndTheScriptItStandsIn) {
  EXPECT_EQ(script_text("\xed\xa0\x80"), "\"\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\"");  // no UTF-8
  EXPECT_EQ(script_text("</script> \"quoted\" \\ \n \xc3\xa9"),
            "\"\\u003c/script> \\\"quoted\\\" \\\\ \\n \xc3\xa9\"");
}

Figure figure_of_two_panels() {
  Figure figure{"name", "title", "sentence"};
  add_panels({{"low", "low [m]", {{"a", 0, {1, 2, 3}}, {"b", 7, {2, 3, 4}}}, {}, Scale::from_zero},
              {"high", "high", {{"a", 0, {1, 10, 900}}}, {{"band", 2, 4}}, Scale::logarithmic}},
             {1, 2, 3}, figure);
  return figure;
}

TEST(ChartJson, HoldsWhatThePanelsShow) {
  const std::string json = chart_json(figure_of_two_panels().chart);
  EXPECT_THAT(json, testing::StartsWith(R"({"x_label":"time [s]","x_from":0,"x_to":3,"panels":[)"));
  EXPECT_THAT(json, HasSubstr(R"({"label":"low [m]","axis":{"logarithmic":false,"low":0,)"
                              R"("high":null},"bands":[],"x":[1,2,3],"curves":[)"
                              R"({"legend":"a","colour":"#0072B2","dash":1,"y":[1,2,3]},)"
                              R"({"legend":"b","colour":"#D55E00","dash":2,"y":[2,3,4]}]})"));
}

TEST(ChartJson, WritesACommonTimeOnce) {
  const std::string json = chart_json(figure_of_two_panels().chart);
  EXPECT_EQ(json.find("\"x\":"), json.rfind("\"x\":"));
  EXPECT_THAT(json, HasSubstr(R"("bands":[{"legend":"band","lower":2,"upper":4}],"curves")"));
}

TEST(ChartJson, HoldsMarksWithTheirFacts) {
  Chart chart{"x [m]", -1, 1, {}};
  ChartPanel& panel = chart.panels.emplace_back();
  panel.cell = "a";
  ChartMarks& marks = panel.marks.emplace_back();
  marks.name = "fix";
  marks.cell = "a";
  marks.shape = ChartMarks::Shape::crosses;
  marks.x = {0, std::numeric_limits<double>::quiet_NaN()};
  marks.y = {1, 2};
  marks.facts = {{"time [s]", {3, 4}}};
  const std::string json = chart_json(chart);
  EXPECT_THAT(json, HasSubstr(R"({"shape":"crosses","name":"fix","legend":"a","colour":"#0072B2",)"
                              R"("dash":1,"x":[0,null],"y":[1,2],)"
                              R"("facts":[{"label":"time [s]","values":[3,4]}]})"));
  EXPECT_THAT(json, testing::Not(HasSubstr("x_first")));
  chart.x_first = 0.5;
  EXPECT_THAT(chart_json(chart), HasSubstr(R"("x_first":0.5)"));
}

TEST(ChartJson, HoldsStripsWithTheirColours) {
  Figure figure{"name", "title", "sentence"};
  add_strips({{"ratio",
               "ratio",
               "grey",
               "mean",
               {{"a", {1.0, 12.3456}, {{0.9, 1.1}, {0.9, 1.1}}, "7.0"}}}},
             {1, 2}, figure);
  const std::string json = chart_json(figure.chart);
  EXPECT_THAT(json, HasSubstr(R"("strips":{"inside":"grey","notes":"mean","scale":)"));
  EXPECT_THAT(json, HasSubstr(R"("colours":["#053061",)"));
  EXPECT_THAT(json, HasSubstr(R"({"level":16,"text":"10"})"));
  EXPECT_THAT(
      json, HasSubstr(R"("rows":[{"name":"a","note":"7.0","ratios":[1,12.3],"levels":[32,16]}])"));
}

TEST(ChartJson, KeepsTheAxisNearABand) {
  const Figure figure = figure_of_two_panels();
  const ChartAxis& axis = figure.chart.panels[1].axis;
  EXPECT_TRUE(axis.logarithmic);
  EXPECT_DOUBLE_EQ(axis.low, 1.0);
  EXPECT_DOUBLE_EQ(axis.high, 900.0);
}

}  // namespace
}  // namespace montecarta::analysis
