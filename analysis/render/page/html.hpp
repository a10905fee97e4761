// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/figure.hpp"
#include "analysis/study/verdict_table.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// Members stand in the order in which they are added.
using Json = nlohmann::ordered_json;

/// A number rounded to `digits` significant digits, since a drawing shows no more. NaN becomes
/// null, and an infinite number the text "+inf" or "-inf", since JSON has neither.
Json rounded(double value, int digits = 5);
/// An array of such numbers.
Json rounded(const std::vector<double>& values, int digits = 5);

/// Compact text that may stand in a page's <script>; bytes that are not UTF-8 are replaced.
std::string script_text(const Json& json);

/// A chart as the page's script reads it (page/script/chart.js).
std::string chart_json(const Chart& chart);

/// The style sheet of the page: analysis/render/page/page.css, put into the program when it is
/// built.
std::string page_style();
/// The scripts of the page, analysis/render/page/script/*.js in the order in which they need each
/// other, as the body of one function.
std::string page_script();

/// A number of a drawing: a tenth is enough for pixels, and for opacities. What is no number is 0.
std::string pixels(double value);

/// Plain text as a page shows it.
std::string html_escape(const std::string& text);

/// A table that scrolls sideways where the page is narrow.
std::string html_table(const TextTable& table);

/// A table of names and values without headings.
std::string html_pairs(const std::vector<std::pair<std::string, std::string>>& pairs);

/// An SVG document made part of a page: without its prologue, with identifiers that begin with
/// `name`, so that several fit on one page, and told aloud as `description`.
std::string inline_svg(const std::string& svg, const std::string& name,
                       const std::string& description);

/// Paragraphs of plain text.
std::string html_paragraphs(const std::vector<std::string>& texts);

/// HTML with a "?" behind it that opens an explanation, which is HTML too; without an explanation
/// the HTML alone, without HTML before it "How to read this".
std::string html_explained(const std::string& html, const std::string& explanation);

/// JSON for the page's script, which looks for this class.
std::string html_data(const std::string& name, const std::string& json);

/// A whole self-contained page, for light and dark screens of any width.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace montecarta::analysis
