// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/html.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

TEST(Html, EscapesText) {
  EXPECT_EQ(html_escape("a < b & \"c\" 3 +- 1"), "a &lt; b &amp; &quot;c&quot; 3 &plusmn; 1");
}

TEST(Html, ColoursWhatIsShownAndNothingElse) {
  const auto row = [](const std::string& verdict) {
    return html_table({.headings = {{"verdict", Align::left}}, .rows = {{verdict}}});
  };
  EXPECT_THAT(row("consistent within 1.1"), testing::HasSubstr("good"));
  EXPECT_THAT(row("optimistic by 1.2 to 1.4"), testing::HasSubstr("bad"));
  EXPECT_THAT(row("undecided: 12 more runs decide"), testing::HasSubstr("<td>undecided"));
}

TEST(Html, GivesEveryDrawingItsOwnIdentifiersAndTheColourOfTheText) {
  const std::string svg =
      "<?xml?><svg><g id=\"a\" fill='rgb(  0,   0,   0)'/><use href='#a'/></svg>";
  EXPECT_EQ(inline_svg(svg, "rmse", "what"),
            "<svg class=\"drawing\" role=\"img\" aria-label=\"what\"><g id=\"rmse_a\" "
            "fill='currentColor'/><use "
            "href='#rmse_a'/></svg>");
}

TEST(Html, HoldsAllStylesAndScripts) {
  const std::string page = html_page("title", "body");
  EXPECT_THAT(page, testing::HasSubstr("\"use strict\";\n" + std::string(page_script())));
  EXPECT_THAT(page_script(), testing::HasSubstr("class Player"));
  EXPECT_THAT(page, testing::HasSubstr(std::string(page_style())));
  EXPECT_THAT(page_style(), testing::HasSubstr("color-scheme: light dark"));
  EXPECT_THAT(page_style(), testing::EndsWith("}\n"));
}

TEST(Html, ForbidsTheBrowserToAskTheNetwork) {
  EXPECT_THAT(html_page("title", "body"), testing::HasSubstr("content=\"default-src 'none';"));
}

}  // namespace
}  // namespace montecarta::analysis
