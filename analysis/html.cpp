// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/html.hpp"

namespace montecarta {
namespace {

// gnuplot draws in black: on a dark page the style turns that into the colour of the text.
constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --page: #fff; --text: #1a1a1a; --soft: #5a5a5a; --line: #d5d5d5;
  --bad: #b3261e; --good: #0b6b3a; }
@media (prefers-color-scheme: dark) {
  :root { --page: #15171a; --text: #e8e8e8; --soft: #a8a8a8; --line: #3a3d42; --bad: #ff8a80;
    --good: #6fd49b; }
}
body { margin: 0 auto; padding: 1rem; max-width: 78rem; background: var(--page);
  color: var(--text); font: 1rem/1.5 system-ui, sans-serif; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: .5rem 0; }
h2 { font-size: 1.15rem; margin: 2.2rem 0 .5rem; }
p { margin: .5rem 0; max-width: 60rem; }
.soft, figcaption { color: var(--soft); font-size: .92rem; }
.scroll { overflow-x: auto; margin-bottom: .8rem; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .5rem; white-space: nowrap; border-bottom: 1px solid var(--line); }
th { text-align: left; font-weight: 600; border-bottom: 2px solid var(--text); }
@media (max-width: 40rem) { td:not(.right) { white-space: normal; min-width: 5rem; } }
.right { text-align: right; }
.bad { color: var(--bad); font-weight: 600; }
.good { color: var(--good); font-weight: 600; }
ul { max-width: 60rem; padding-left: 1.2rem; }
figure { margin: .5rem 0; }
figcaption { max-width: 60rem; }
figure svg { width: 100%; height: auto; display: block; color: var(--text); }
svg [color="black"] { color: inherit; }
svg [fill="black"] { fill: currentColor; }
a { color: inherit; }
pre { overflow-x: auto; font-size: .8rem; border-left: 3px solid var(--line); padding-left: .8rem; }
summary { cursor: pointer; font-weight: 600; margin-top: 1rem; }
)";

/// Verdicts and failures are seen at a glance; the word itself says the same without the colour.
std::string class_of(const std::string& text, Align align) {
  std::string names = align == Align::right ? "right" : "";
  const bool bad = text.starts_with("inconsistent") || text.starts_with("optimistic") ||
                   text.starts_with("not reproduced") || text.starts_with("contradicted") ||
                   text.starts_with("better in no") || text.find("FAILED") != std::string::npos;
  if (bad) names += " bad";
  const bool good = text == "consistent" || text.starts_with("agrees") ||
                    text.starts_with("holds") || text.starts_with("better in every");
  if (good) names += " good";
  return names.empty() ? "" : " class=\"" + names + "\"";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

}  // namespace

std::string html_escape(const std::string& text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return replaced(html, "+-", "&plusmn;");
}

std::string html_table(const TextTable& table) {
  std::string html = "<div class=\"scroll\"><table>\n<thead><tr>";
  for (const auto& heading : table.headings) {
    html += std::string("<th scope=\"col\"") +
            (heading.align == Align::right ? " class=\"right\">" : ">") +
            html_escape(heading.text) + "</th>";
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c) {
      html +=
          "<td" + class_of(row[c], table.headings[c].align) + ">" + html_escape(row[c]) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string html_pairs(const std::vector<std::pair<std::string, std::string>>& pairs) {
  std::string html = "<div class=\"scroll\"><table><tbody>\n";
  for (const auto& [name, value] : pairs) {
    html += "<tr><th scope=\"row\">" + html_escape(name) + "</th><td>" + html_escape(value) +
            "</td></tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string inline_svg(const std::string& svg, const std::string& name,
                       const std::string& description) {
  const std::size_t begin = svg.find("<svg");
  if (begin == svg.npos) return "<p>" + html_escape(description) + "</p>";
  std::string part = svg.substr(begin);
  part = replaced(part, "id=\"", "id=\"" + name + "_");
  part = replaced(part, "id='", "id='" + name + "_");
  part = replaced(part, "href='#", "href='#" + name + "_");
  part = replaced(part, "url(#", "url(#" + name + "_");
  // The paper belongs to the file alone: on a page the page is the paper.
  part = replaced(part, "fill=\"#ffffff\"", "fill=\"none\"");
  // Black on a light page, light on a dark one; gnuplot writes it in two ways.
  part = replaced(part, "rgb(0,0,0)", "currentColor");
  part = replaced(part, "rgb(  0,   0,   0)", "currentColor");
  return replaced(part, "<svg",
                  "<svg role=\"img\" aria-label=\"" + html_escape(description) + "\"");
}

std::string html_page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         html_escape(title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n" + body +
         "</body>\n</html>\n";
}

}  // namespace montecarta
