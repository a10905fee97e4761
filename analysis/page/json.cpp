// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/json.hpp"

#include "analysis/output/figure.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace montecarta::analysis {
namespace {

/// A character within quotes. "<" may not stand in a script: it could end it.
std::string json_escaped(char c) {
  constexpr std::string_view kHex = "0123456789abcdef";
  if (c == '"' || c == '\\') return {'\\', c};
  const auto code = static_cast<unsigned char>(c);
  if (code >= 0x20 && c != '<') return {c};
  return std::string("\\u00") + kHex[code >> 4U] + kHex[code & 15U];
}

/// Nothing is written of what is empty: a page has many panels.
template <class Values>
void write_if_any(const char* name, const Values& values, JsonWriter& json) {
  if (!values.empty()) json.member(name, values);
}

void write_axis(const ChartAxis& axis, JsonWriter& json) {
  json.key("axis").begin_object();
  json.member("logarithmic", axis.logarithmic).member("low", axis.low).member("high", axis.high);
  json.end_object();
}

void write_bands(const std::vector<Band>& bands, JsonWriter& json) {
  json.key("bands").begin_array();
  for (const Band& band : bands) {
    json.begin_object().member("legend", band.legend);
    json.member("lower", band.lower).member("upper", band.upper).end_object();
  }
  json.end_array();
}

void write_style(std::size_t style, JsonWriter& json) {
  json.member("colour", line_colour(style)).member("dash", line_dashes(style));
}

void write_curves(const std::vector<ChartPanel::Curve>& curves, JsonWriter& json) {
  json.key("curves").begin_array();
  for (const ChartPanel::Curve& curve : curves) {
    json.begin_object().member("legend", curve.legend);
    write_style(curve.style, json);
    json.member("y", curve.values);
    write_if_any("least", curve.least, json);
    write_if_any("greatest", curve.greatest, json);
    json.end_object();
  }
  json.end_array();
}

void write_facts(const std::vector<ChartMarks::Fact>& facts, JsonWriter& json) {
  json.key("facts").begin_array();
  for (const ChartMarks::Fact& fact : facts) {
    json.begin_object().member("label", fact.label).member("values", fact.values).end_object();
  }
  json.end_array();
}

void write_marks(const std::vector<ChartMarks>& all, JsonWriter& json) {
  constexpr std::array kShapes = {"line", "points", "crosses", "ellipses", "boxes"};
  if (all.empty()) return;
  json.key("marks").begin_array();
  for (const ChartMarks& marks : all) {
    json.begin_object().member("shape", kShapes[static_cast<std::size_t>(marks.shape)]);
    json.member("name", marks.name).member("legend", marks.cell);
    write_style(marks.style, json);
    if (marks.thickness > 0.0) json.member("thickness", marks.thickness);
    json.member("x", marks.x).member("y", marks.y);
    write_if_any("width", marks.width, json);
    write_if_any("height", marks.height, json);
    write_if_any("angle", marks.angle, json);
    write_if_any("fill", marks.fill, json);
    write_if_any("text", marks.text, json);
    write_facts(marks.facts, json);
    json.end_object();
  }
  json.end_array();
}

void write_panel(const ChartPanel& panel, const std::vector<double>* x_above, JsonWriter& json) {
  json.begin_object().member("label", panel.label);
  write_if_any("cell", panel.cell, json);
  write_axis(panel.axis, json);
  write_bands(panel.bands, json);
  // A panel without x has that of the panel above.
  if (x_above == nullptr || *x_above != panel.x) json.member("x", panel.x);
  write_curves(panel.curves, json);
  write_marks(panel.marks, json);
  write_if_any("x_names", panel.x_names, json);
  write_if_any("y_names", panel.y_names, json);
  json.end_object();
}

}  // namespace

void JsonWriter::separate() {
  if (!first_) text_ += ',';
  first_ = false;
}

JsonWriter& JsonWriter::begin(char bracket) {
  separate();
  text_ += bracket;
  first_ = true;
  return *this;
}

JsonWriter& JsonWriter::end(char bracket) {
  text_ += bracket;
  first_ = false;
  return *this;
}

JsonWriter& JsonWriter::literal(std::string_view text) {
  separate();
  text_ += text;
  return *this;
}

JsonWriter& JsonWriter::key(std::string_view name) {
  value(name);
  text_ += ':';
  first_ = true;
  return *this;
}

JsonWriter& JsonWriter::value(std::string_view text) {
  separate();
  text_ += '"';
  for (const char c : text) text_ += json_escaped(c);
  text_ += '"';
  return *this;
}

JsonWriter& JsonWriter::value(double number, int digits) {
  if (std::isnan(number)) return literal("null");
  if (std::isinf(number)) return literal(number > 0.0 ? "1e999" : "-1e999");
  std::array<char, 32> buffer{};
  const auto written = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number,
                                     std::chars_format::general, digits);
  return literal({buffer.data(), written.ptr});
}

JsonWriter& JsonWriter::exact(double number) {
  if (!std::isfinite(number)) return value(number);
  std::array<char, 32> buffer{};
  const auto written = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  const std::string_view text(buffer.data(), written.ptr);
  literal(text);
  if (text.find_first_of(".e") == std::string_view::npos) text_ += ".0";
  return *this;
}

std::string chart_json(const Chart& chart) {
  JsonWriter json;
  json.begin_object().member("x_label", chart.x_label);
  json.member("x_from", chart.x_from).member("x_to", chart.x_to);
  if (!std::isnan(chart.x_first)) json.member("x_first", chart.x_first);
  if (chart.x_logarithmic) json.member("x_logarithmic", true);
  if (chart.columns > 1) json.member("columns", chart.columns).member("least", chart.least);
  if (chart.aspect > 0.0) json.member("aspect", chart.aspect);
  if (chart.is_map) json.member("is_map", true);
  json.key("panels").begin_array();
  const std::vector<double>* last = nullptr;
  for (const ChartPanel& panel : chart.panels) {
    write_panel(panel, last, json);
    last = &panel.x;
  }
  return json.end_array().end_object().text();
}

}  // namespace montecarta::analysis
