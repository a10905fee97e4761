// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/html.hpp"

namespace montecarta::analysis {
namespace {

/// A browser that reads this asks nobody for anything, not even for an icon.
constexpr const char* kNoNetwork =
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
    "style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:\">\n"
    "<link rel=\"icon\" href=\"data:,\">\n";

/// Verdicts and failures are seen at a glance; the word itself says the same without the colour.
std::string class_of(const std::string& text, Align align) {
  std::string names = align == Align::right ? "right" : "";
  const bool bad = text.starts_with("optimistic") || text.starts_with("not reproduced") ||
                   text.starts_with("contradicted") || text.starts_with("better in no") ||
                   text.find("FAILED") != std::string::npos;
  if (bad) names += " bad";
  const bool good = text.starts_with("consistent within") || text.starts_with("agrees") ||
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
  return replaced(
      part, "<svg",
      "<svg class=\"drawing\" role=\"img\" aria-label=\"" + html_escape(description) + "\"");
}

std::string html_data(const std::string& name, const std::string& json) {
  return "<script type=\"application/json\" class=\"" + name + "\">" + json + "</script>\n";
}

std::string html_page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n" +
         std::string(kNoNetwork) + "<title>" + html_escape(title) + "</title>\n<style>\n" +
         std::string(page_style()) + "</style>\n</head>\n<body>\n" + body +
         "<script>\n(() => {\n\"use strict\";\n" + std::string(page_script()) +
         "})();\n</script>\n</body>\n</html>\n";
}

}  // namespace montecarta::analysis
