// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/chart_json.hpp"

#include "analysis/figures/figure.hpp"
#include "analysis/page/json.hpp"

namespace montecarta {
namespace {

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

void write_curves(const std::vector<ChartPanel::Curve>& curves, JsonWriter& json) {
  json.key("curves").begin_array();
  for (const ChartPanel::Curve& curve : curves) {
    json.begin_object().member("legend", curve.legend).member("colour", line_colour(curve.style));
    json.member("dash", line_dashes(curve.style)).member("y", curve.values).end_object();
  }
  json.end_array();
}

}  // namespace

std::string chart_json(const Chart& chart) {
  JsonWriter json;
  json.begin_object().member("x_label", chart.x_label);
  json.member("x_from", chart.x_from).member("x_to", chart.x_to);
  json.key("panels").begin_array();
  const std::vector<double>* last = nullptr;
  for (const ChartPanel& panel : chart.panels) {
    json.begin_object().member("label", panel.label);
    write_axis(panel.axis, json);
    write_bands(panel.bands, json);
    // A panel without x has that of the panel above.
    if (last == nullptr || *last != panel.x) json.member("x", panel.x);
    last = &panel.x;
    write_curves(panel.curves, json);
    json.end_object();
  }
  return json.end_array().end_object().text();
}

}  // namespace montecarta
