// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/pareto.hpp"

#include "analysis/metrics/nees_accumulator.hpp"
#include "analysis/statistics/spread.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

bool is_known(const Offer& offer) { return std::isfinite(offer.cost) && std::isfinite(offer.loss); }

bool beats(const Offer& a, const Offer& b) {
  if (!is_known(a)) return false;
  return a.cost <= b.cost && a.loss <= b.loss && (a.cost < b.cost || a.loss < b.loss);
}

/// By ANEES; NaN if the cell is not tested.
double nees_distance_of(const CellAnalysis& cell) {
  const NeesResult* nees = cell.find_nees(ErrorBlock::pose, cell.leading);
  if (nees == nullptr || nees->consistency.verdict == Verdict::untested) return kNaN;
  return nees_distance(nees->consistency.mean, nees->series.dimension);
}

CellValue value_of(const CellAnalysis& cell, std::size_t place) {
  return {.cell = cell.label,
          .place = place,
          .failed = cell.failures.size(),
          .cpu_seconds = cell.over_runs("cpu_seconds"),
          .position_rmse = cell.over_runs("position_rmse"),
          .verdict = in_words(cell.consistency()),
          .nees_distance = nees_distance_of(cell)};
}

/// One panel: a loss against cost.
struct Merit {
  std::string name;  ///< of its data file
  std::string label;
  double (*loss)(const CellValue&);
  bool CellValue::*on_front;
};

const Merit kMerits[] = {
    {"pareto_accuracy", "position RMSE [m]",
     [](const CellValue& value) { return value.position_rmse.mean; },
     &CellValue::accurate_for_cost},
    {"pareto_consistency", "NEES distance [doublings]",
     [](const CellValue& value) { return value.nees_distance; }, &CellValue::consistent_for_cost}};

double cost_of(const CellValue& value) { return value.cpu_seconds.mean; }

FigureData data_of(std::span<const CellValue> values, const Merit& merit) {
  FigureData data{merit.name + ".csv", {"cpu_seconds [s]", merit.label, "on the front"}, {}};
  for (const CellValue& value : values) {
    data.rows.push_back({cost_of(value), merit.loss(value), value.*merit.on_front ? 1.0 : 0.0});
  }
  return data;
}

constexpr double kLeastShown = 1e-100, kMostShown = 1e100;  // what else there is, is damage

/// Ends of an axis.
struct CostRange {
  double least = std::numeric_limits<double>::infinity();
  double greatest = 0.0;

  void include(double value) {
    if (!(value >= kLeastShown && value <= kMostShown)) return;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
};

/// Of the costs, with room for points.
CostRange cost_range(std::span<const CellValue> values) {
  CostRange range;
  for (const CellValue& value : values) range.include(cost_of(value));
  if (range.greatest == 0.0) return {0.1, 10.0};
  return {range.least / 1.5, 1.5 * range.greatest};
}

/// From zero, with room for labels.
double top_of(std::span<const CellValue> values, const Merit& merit) {
  CostRange range;
  for (const CellValue& value : values) range.include(merit.loss(value));
  return range.greatest > 0.0 ? 1.15 * range.greatest : 1.0;
}

using Corners = std::vector<std::pair<double, double>>;  ///< (cost, loss)

/// The front from edge to edge: what lies above and to the right of it is beaten.
Corners corners_of(std::span<const CellValue> values, const Merit& merit, const CostRange& costs) {
  Corners corners;
  for (const CellValue& value : values) {
    if (value.*merit.on_front) corners.emplace_back(cost_of(value), merit.loss(value));
  }
  std::ranges::sort(corners);
  if (!corners.empty()) {
    corners.insert(corners.begin(), {corners.front().first, top_of(values, merit)});
    corners.emplace_back(costs.greatest, corners.back().second);
  }
  return corners;
}

/// As steps.
ChartMarks front_marks(std::span<const CellValue> values, const Merit& merit,
                       const CostRange& costs) {
  ChartMarks front;
  front.style = kReferenceStyle;
  double above = 0.0;
  for (const auto& [cost, loss] : corners_of(values, merit, costs)) {
    if (!front.x.empty()) {
      front.x.push_back(cost);
      front.y.push_back(above);
    }
    front.x.push_back(cost);
    front.y.push_back(above = loss);
  }
  return front;
}

ChartPanel chart_panel(std::span<const CellValue> values, const Merit& merit,
                       const CostRange& costs) {
  ChartPanel panel{merit.label, {false, 0.0, top_of(values, merit)}, {}, {}, {}};
  panel.marks.push_back(front_marks(values, merit, costs));
  for (const CellValue& value : values) {
    ChartMarks& point = panel.marks.emplace_back();
    point.cell = value.cell;
    point.style = value.place;
    point.shape = ChartMarks::Shape::points;
    point.thickness = 10.0;
    point.x = {cost_of(value)};
    point.y = {merit.loss(value)};
    point.text = {value.cell};
    point.facts = {{merit.label, point.y}, {"CPU time of a run [s]", point.x}};
  }
  return panel;
}

Chart chart_of(std::span<const CellValue> values, const CostRange& costs) {
  Chart chart{"CPU time of a run [s]", costs.least, costs.greatest, {}, true};
  chart.columns = std::size(kMerits);
  chart.least = 300;
  chart.aspect = 0.65;
  for (const Merit& merit : kMerits) chart.panels.push_back(chart_panel(values, merit, costs));
  return chart;
}

}  // namespace

std::vector<bool> pareto_front(std::span<const Offer> offers) {
  std::vector<bool> front;
  for (const Offer& offer : offers) {
    const auto beats_it = [&](const Offer& other) { return beats(other, offer); };
    front.push_back(is_known(offer) && std::ranges::none_of(offers, beats_it));
  }
  return front;
}

std::vector<CellValue> cell_values(const StudyAnalysis& study) {
  std::vector<CellValue> values;
  if (!study.has_truth) return values;
  for (std::size_t i = 0; i < study.cells.size(); ++i) {
    if (study.cells[i].complete > 0) values.push_back(value_of(study.cells[i], i));
  }
  std::vector<Offer> accuracy, consistency;
  for (const CellValue& value : values) {
    accuracy.push_back({value.cpu_seconds.mean, value.position_rmse.mean});
    consistency.push_back({value.cpu_seconds.mean, value.nees_distance});
  }
  const std::vector<bool> accurate = pareto_front(accuracy), consistent = pareto_front(consistency);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i].accurate_for_cost = accurate[i];
    values[i].consistent_for_cost = consistent[i];
  }
  return values;
}

Figure pareto_figure(std::span<const CellValue> values) {
  Figure figure{"pareto", "What does a better answer cost?", ""};
  figure.sentence =
      "Each point is a cell, over its complete runs: left its position error, right how far its "
      "NEES is from consistency (0: consistent; 1: off by a factor of 2), both against the "
      "processor "
      "time of a run. Down and to the left is better; the dashed line is the Pareto front, and "
      "whatever lies above it is beaten by a cell on it.";
  std::vector<CellValue> priced(values.begin(), values.end());
  std::erase_if(priced, [](const CellValue& value) { return !(cost_of(value) > 0.0); });
  if (priced.size() < 2) return figure;
  const CostRange costs = cost_range(priced);
  for (const Merit& merit : kMerits) figure.data.push_back(data_of(priced, merit));
  figure.chart = chart_of(priced, costs);
  return figure;
}

}  // namespace montecarta::analysis
