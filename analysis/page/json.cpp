// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/json.hpp"

#include "analysis/output/figure.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace montecarta::analysis {
namespace {

/// Nothing is written of what is empty: a page has many panels.
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

Json json_of(const ChartPanel::Curve& curve) {
  Json json = {{"legend", curve.legend}};
  add_style(curve.style, json);
  json["y"] = rounded(curve.values);
  add_if_any("least", curve.least, json);
  add_if_any("greatest", curve.greatest, json);
  return json;
}

Json json_of(const ChartMarks& marks) {
  constexpr std::array kShapes = {"line", "points", "crosses", "ellipses", "boxes"};
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
  add_if_any("fill", marks.fill, json);
  add_if_any("text", marks.text, json);
  Json& facts = json["facts"] = Json::array();
  for (const ChartMarks::Fact& fact : marks.facts) {
    facts.push_back({{"label", fact.label}, {"values", fact.values}});
  }
  return json;
}

template <class Element>
Json array_of(const std::vector<Element>& elements) {
  Json array = Json::array();
  for (const Element& element : elements) array.push_back(json_of(element));
  return array;
}

/// A panel without x has that of the panel above.
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
  add_if_any("x_names", panel.x_names, json);
  add_if_any("y_names", panel.y_names, json);
  return json;
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
  std::string text = json.dump();
  // "<" could end the script, and is found within texts only.
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

std::string chart_json(const Chart& chart) {
  Json json = {
      {"x_label", chart.x_label}, {"x_from", rounded(chart.x_from)}, {"x_to", rounded(chart.x_to)}};
  if (!std::isnan(chart.x_first)) json["x_first"] = rounded(chart.x_first);
  if (chart.x_logarithmic) json["x_logarithmic"] = true;
  if (chart.columns > 1) {
    json["columns"] = chart.columns;
    json["least"] = chart.least;
  }
  if (chart.aspect > 0.0) json["aspect"] = rounded(chart.aspect);
  if (chart.is_map) json["is_map"] = true;
  Json& panels = json["panels"] = Json::array();
  const std::vector<double>* last = nullptr;
  for (const ChartPanel& panel : chart.panels) {
    panels.push_back(json_of(panel, last));
    last = &panel.x;
  }
  return script_text(json);
}

}  // namespace montecarta::analysis
