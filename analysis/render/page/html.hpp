// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/figure.hpp"
#include "analysis/study/verdict_table.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// A JSON value whose members keep the order in which they are added.
using Json = nlohmann::ordered_json;

/// A number rounded to `digits` significant digits, since a drawing shows no more. NaN becomes
/// null, and an infinite number the text "+inf" or "-inf", since JSON has neither.
Json rounded(double value, int digits = 5);
/// An array of numbers that are rounded in the same way.
Json rounded(const std::vector<double>& values, int digits = 5);

/// Compact text that may stand in a page's <script>; bytes that are not UTF-8 are replaced.
std::string script_text(const Json& json);

/// A chart in the form that the page's script reads (page/script/chart.js).
std::string chart_json(const Chart& chart);

/// The style sheet of the page, analysis/render/page/page.css, which is built into the program.
std::string page_style();
/// The scripts of the page, analysis/render/page/script/*.js in the order in which they need each
/// other, as the body of one function.
std::string page_script();

/// Text of a number in a drawing, to a tenth, which is enough for pixels and opacities. NaN becomes
/// 0.
std::string pixels(double value);

/// Plain text escaped for HTML.
std::string html_escape(const std::string& text);

/// A table that scrolls sideways where the page is narrow.
std::string html_table(const TextTable& table);

/// A table of names and values without headings.
std::string html_pairs(const std::vector<std::pair<std::string, std::string>>& pairs);

/// An SVG document as part of a page: without its prologue, with identifiers that begin with
/// `name`, so that several fit on one page, and with `description` as its text for screen readers.
std::string inline_svg(const std::string& svg, const std::string& name,
                       const std::string& description);

/// Paragraphs of plain text.
std::string html_paragraphs(const std::vector<std::string>& texts);

/// HTML followed by a "?" that opens `explanation`, which is HTML too. Without an explanation it is
/// the HTML alone; without HTML, "How to read this" stands before the "?".
std::string html_explained(const std::string& html, const std::string& explanation);

/// A JSON element for the page's script, which finds it by the class `name`.
std::string html_data(const std::string& name, const std::string& json);

/// A whole self-contained page, for light and dark screens of any width.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace montecarta::analysis
