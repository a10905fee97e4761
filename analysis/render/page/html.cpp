// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/page/html.hpp"

#include "analysis/study/strips.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace montecarta::analysis {
namespace {

/// Adds values under their name. Leaves them out if they are empty, because a page has many panels.
template <class Values>
void add_if_any(const char* name, const Values& values, Json& json) {
  if (values.empty()) return;
  if constexpr (std::is_same_v<Values, std::vector<double>>) {
    json[name] = rounded(values);
  } else {
    json[name] = values;
  }
}

Json json_of(const Band& band) {
  return {{"legend", band.legend}, {"lower", rounded(band.lower)}, {"upper", rounded(band.upper)}};
}

void add_style(std::size_t style, Json& json) {
  json["colour"] = line_colour(style);
  json["dash"] = line_dashes(style);
}

Json json_of(const Curve& curve) {
  Json json = {{"legend", curve.legend}};
  add_style(curve.style, json);
  json["y"] = rounded(curve.values);
  add_if_any("envelope", curve.envelope, json);
  return json;
}

Json json_of(const ChartMarks& marks) {
  constexpr std::array kShapes = {"line", "points", "crosses", "ellipses"};
  Json json = {{"shape", kShapes[static_cast<std::size_t>(marks.shape)]},
               {"name", marks.name},
               {"legend", marks.cell}};
  add_style(marks.style, json);
  if (marks.thickness > 0.0) json["thickness"] = rounded(marks.thickness);
  json["x"] = rounded(marks.x);
  json["y"] = rounded(marks.y);
  add_if_any("width", marks.width, json);
  add_if_any("height", marks.height, json);
  add_if_any("angle", marks.angle, json);
  Json& facts = json["facts"] = Json::array();
  for (const ChartMarks::Fact& fact : marks.facts) {
    facts.push_back({{"label", fact.label}, {"values", rounded(fact.values)}});
  }
  return json;
}

template <class Element>
Json array_of(const std::vector<Element>& elements) {
  Json array = Json::array();
  for (const Element& element : elements) array.push_back(json_of(element));
  return array;
}

Json json_of(const ChartStrips& strips) {
  Json json = {{"inside", strips.inside},
               {"notes", strips.notes},
               {"scale", kStripScale},
               {"colours", strip_colours()}};
  for (const StripTick& tick : strip_ticks())
    json["ticks"].push_back({{"level", tick.level}, {"text", tick.text}});
  for (const ChartStrips::Row& row : strips.rows) {
    json["rows"].push_back({{"name", row.name},
                            {"note", row.note},
                            {"ratios", rounded(row.ratios, 3)},
                            {"levels", row.levels}});
  }
  return json;
}

/// JSON of a panel. A panel without x has the x of the panel above.
Json json_of(const ChartPanel& panel, const std::vector<double>* x_above) {
  Json json = {{"label", panel.label}};
  add_if_any("cell", panel.cell, json);
  json["axis"] = {{"logarithmic", panel.axis.logarithmic},
                  {"low", rounded(panel.axis.low)},
                  {"high", rounded(panel.axis.high)}};
  json["bands"] = array_of(panel.bands);
  if (x_above == nullptr || *x_above != panel.x) json["x"] = rounded(panel.x);
  json["curves"] = array_of(panel.curves);
  if (!panel.marks.empty()) json["marks"] = array_of(panel.marks);
  if (!panel.strips.rows.empty()) json["strips"] = json_of(panel.strips);
  add_if_any("names", panel.names, json);
  return json;
}

/// A policy that keeps the browser from loading anything, even an icon.
constexpr const char* kNoNetwork =
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
    "style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:\">\n"
    "<link rel=\"icon\" href=\"data:,\">\n";

/// The CSS class by which a text is aligned and coloured. The word itself says the same without the
/// colour.
std::string class_of(const std::string& text, Align align, Tone tone) {
  // [characters] longer texts are broken into lines on a narrow page.
  constexpr std::size_t kLong = 24;
  std::string names = align == Align::right ? "right" : text.size() > kLong ? "long" : "";
  if (tone == Tone::bad) names += " bad";
  if (tone == Tone::good) names += " good";
  return names.empty() ? "" : " class=\"" + names + "\"";
}

}  // namespace

Json rounded(double value, int digits) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0.0 ? "+inf" : "-inf";
  if (value == std::floor(value) && std::abs(value) < 1e4) return static_cast<int>(value);
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value,
                                     std::chars_format::general, digits);
  double nearest = value;
  std::from_chars(text.data(), written.ptr, nearest);
  return nearest;
}

Json rounded(const std::vector<double>& values, int digits) {
  Json array = Json::array();
  for (const double value : values) array.push_back(rounded(value, digits));
  return array;
}

std::string script_text(const Json& json) {
  // "<" could end the script; it occurs only within texts.
  return replaced(json.dump(-1, ' ', false, Json::error_handler_t::replace), "<", "\\u003c");
}

std::string chart_json(const Chart& chart) {
  Json json = {
      {"x_label", chart.x_label}, {"x_from", rounded(chart.x_from)}, {"x_to", rounded(chart.x_to)}};
  if (!std::isnan(chart.x_first)) json["x_first"] = rounded(chart.x_first);
  if (chart.columns > 1) {
    json["columns"] = chart.columns;
    json["least"] = chart.least;
  }
  if (chart.aspect > 0.0) json["aspect"] = rounded(chart.aspect);
  if (chart.is_map) json["is_map"] = true;
  if (chart.x_logarithmic) json["x_logarithmic"] = true;
  add_if_any("x_names", chart.x_names, json);
  Json& panels = json["panels"] = Json::array();
  const std::vector<double>* last = nullptr;
  for (const ChartPanel& panel : chart.panels) {
    panels.push_back(json_of(panel, last));
    last = &panel.x;
  }
  return script_text(json);
}

std::string pixels(double value) {
  if (!std::isfinite(value)) return "0";
  return exact_text(std::round(std::clamp(value, -1e6, 1e6) * 10.0) / 10.0);
}

std::string html_escape(const std::string& text) {
  std::string html = replaced(replaced(text, "&", "&amp;"), "<", "&lt;");
  html = replaced(replaced(html, ">", "&gt;"), "\"", "&quot;");
  html = replaced(html, " %", "&#160;%");  // a number and its percent sign stay together
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
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    html += "<tr>";
    for (std::size_t c = 0; c < table.rows[r].size(); ++c) {
      const std::string& text = table.rows[r][c];
      html += "<td" + class_of(text, table.headings[c].align, table.tone_at(r, c)) + ">" +
              html_escape(text) + "</td>";
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
  // Only the file has a white background; on a page there is none.
  part = replaced(part, "fill=\"#ffffff\"", "fill=\"none\"");
  // Black becomes the colour of the text, which is light on a dark page; gnuplot writes black in
  // two ways.
  part = replaced(part, "rgb(0,0,0)", "currentColor");
  part = replaced(part, "rgb(  0,   0,   0)", "currentColor");
  return replaced(
      part, "<svg",
      "<svg class=\"drawing\" role=\"img\" aria-label=\"" + html_escape(description) + "\"");
}

std::string html_paragraphs(const std::vector<std::string>& texts) {
  std::string html;
  for (const std::string& text : texts) html += "<p>" + html_escape(text) + "</p>\n";
  return html;
}

std::string html_explained(const std::string& html, const std::string& explanation) {
  if (explanation.empty()) return html;
  return "<details class=\"why\"><summary>" + (html.empty() ? "How to read this" : html) +
         " <span class=\"ask\">?</span></summary>\n" + explanation + "</details>\n";
}

std::string html_data(const std::string& name, const std::string& json) {
  return "<script type=\"application/json\" class=\"" + name + "\">" + json + "</script>\n";
}

std::string html_page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n" +
         std::string(kNoNetwork) + "<title>" + html_escape(title) + "</title>\n<style>\n" +
         page_style() + "</style>\n</head>\n<body>\n" + body +
         "<script>\n(() => {\n\"use strict\";\n" + page_script() +
         "})();\n</script>\n</body>\n</html>\n";
}

}  // namespace montecarta::analysis
