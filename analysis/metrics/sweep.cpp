// SPDX-License-Identifier: BSD-3-Clause
// Summary metrics against an option that the study varies (STATISTICS 25).
#include "analysis/study/sweep.hpp"

#include "analysis/study/cell_report.hpp"
#include "analysis/study/verdict_table.hpp"
#include "engine/text/list_text.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

/// A number of a cell with its interval; NaN where it has none.
struct SweepValue {
  double value = kNaN;
  Interval interval{kNaN, kNaN};
};

/// A number that is shown against the option.
struct SweepNumber {
  std::string name;     ///< name of its data file
  std::string heading;  ///< in the table and at the axis, with the unit
  Scale scale = Scale::automatic;
  std::function<SweepValue(const CellAnalysis&)> value;
  std::function<std::string(const CellAnalysis&)> text;
};

/// The mean of a score, times `factor`. If the values of runs have a heavy tail, it has no
/// interval, and the text is that of the median.
SweepNumber of_score(const StudyAnalysis& study, const char* score, const char* heading,
                     double factor = 1.0) {
  const double level = study.level;
  return {score, heading, Scale::automatic,
          [=](const CellAnalysis& cell) {
            const double mean = factor * cell.over_runs(score).mean;
            if (is_heavy_tailed(cell.scores.column(score))) return SweepValue{mean};
            const Interval interval = cell.interval_of(score);
            return SweepValue{mean, {factor * interval.lower, factor * interval.upper}};
          },
          [=](const CellAnalysis& cell) {
            const MeanText text = score_text(cell, score, level, factor);
            return text.median.empty() ? text.mean : "median " + text.median;
          }};
}

SweepNumber nees_ratio_number() {
  return {"nees_ratio", "NEES ratio", Scale::automatic,
          [](const CellAnalysis& cell) {
            return SweepValue{cell.verdict.ratio_estimate(), cell.verdict.ratio()};
          },
          ratio_text};
}

/// The numbers that at least one cell of the study has.
std::vector<SweepNumber> sweep_numbers(const StudyAnalysis& study) {
  std::vector<SweepNumber> all = {
      of_score(study, "position_rmse", "position RMSE [m]"),
      of_score(study, "heading_rmse", "heading RMSE [deg]", 180.0 / kPi),
      of_score(study, "reference_aligned_rms", "distance to the reference [m]"),
      nees_ratio_number(),
      of_score(study, "ancestors_10_s_ago", "ancestors 10 s ago"),
      of_score(study, "evolution_gain", "gain by evolution [nat]"),
      of_score(study, "evolution_displacement", "displacement by evolution [sigma]"),
      of_score(study, "cpu_seconds", "CPU/run [s]")};
  std::erase_if(all, [&](const SweepNumber& number) {
    return std::ranges::none_of(study.cells, [&](const CellAnalysis& cell) {
      return std::isfinite(number.value(cell).value);
    });
  });
  return all;
}

/// A vertical axis around values and intervals.
ChartAxis sweep_axis(const SweepNumber& number, const Sweep& sweep) {
  double least = kNaN, greatest = kNaN;
  for (const SweepCurve& curve : sweep.curves) {
    for (const CellAnalysis* cell : curve.cells) {
      if (cell == nullptr) continue;
      const auto [value, interval] = number.value(*cell);
      for (const double one : {value, interval.lower, interval.upper}) {
        if (!std::isfinite(one)) continue;
        least = std::fmin(least, one);
        greatest = std::fmax(greatest, one);
      }
    }
  }
  constexpr double kLogarithmicSpan = 30.0, kRoom = 1.06;
  if (least > 0.0 && greatest > kLogarithmicSpan * least)
    return {true, least / (kRoom * kRoom), greatest * kRoom * kRoom};
  const double high = greatest > 0.0 ? kRoom * greatest : 1.0;
  return {false, std::min(0.0, kRoom * least), high};
}

/// Adds an interval at x = `at` to a line: a bar with a cap at each end.
void add_interval(const Interval& interval, double at, ChartMarks& bars) {
  constexpr double kCap = 0.04;  // half the width of a cap, of the distance of values
  const auto add = [&](double from_x, double from_y, double to_x, double to_y) {
    bars.x.insert(bars.x.end(), {from_x, to_x, kNaN});
    bars.y.insert(bars.y.end(), {from_y, to_y, kNaN});
  };
  if (!std::isfinite(interval.lower) || !std::isfinite(interval.upper)) return;
  add(at, interval.lower, at, interval.upper);
  for (const double end : {interval.lower, interval.upper}) add(at - kCap, end, at + kCap, end);
}

/// The marks of one curve: a line through its values, their intervals, and points with facts.
void add_curve(const Sweep& sweep, std::size_t style, const SweepNumber& number,
               std::vector<ChartMarks>& all) {
  constexpr double kPoint = 6.0;  // [px]
  const SweepCurve& curve = sweep.curves[style];
  ChartMarks line;
  line.cell = curve.name;
  line.style = style;
  ChartMarks bars = line, points = line;
  points.shape = ChartMarks::Shape::points;
  points.thickness = kPoint;
  points.facts = {{number.heading, {}}, {"lower end", {}}, {"upper end", {}}};
  for (std::size_t k = 0; k < curve.cells.size(); ++k) {
    if (curve.cells[k] == nullptr) continue;
    const auto [value, interval] = number.value(*curve.cells[k]);
    const auto at = static_cast<double>(k);
    for (ChartMarks* marks : {&line, &points}) {
      marks->x.push_back(std::isnan(value) ? kNaN : at);
      marks->y.push_back(value);
    }
    points.facts[0].values.push_back(value);
    points.facts[1].values.push_back(interval.lower);
    points.facts[2].values.push_back(interval.upper);
    add_interval(interval, at, bars);
  }
  for (ChartMarks* marks : {&line, &bars, &points}) all.push_back(std::move(*marks));
}

/// The numbers behind a panel.
Frame sweep_data(const Sweep& sweep, const SweepNumber& number) {
  Frame frame;
  for (const SweepCurve& curve : sweep.curves) {
    for (std::size_t k = 0; k < sweep.values.size(); ++k) {
      if (curve.cells[k] == nullptr) continue;
      const auto [value, interval] = number.value(*curve.cells[k]);
      frame.add({{"curve", curve.name},
                 {sweep.option, sweep.values[k]},
                 {number.name, "1", value},
                 {"lower", "1", interval.lower},
                 {"upper", "1", interval.upper}});
    }
  }
  return frame;
}

std::string name_of_sweep(const Sweep& sweep) { return "sweep_" + sweep.option; }

Figure sweep_figure(const StudyAnalysis& study, const Sweep& sweep) {
  constexpr std::size_t kColumns = 2, kLeastWidth = 330;
  Figure figure =
      figure_of("sweep", {{"option", sweep.option}, {"level", level_text(study.level)}});
  figure.name = name_of_sweep(sweep);
  Chart& chart = figure.chart;
  chart.x_label = sweep.option;
  chart.x_names = sweep.values;
  chart.x_from = -0.25;
  chart.x_to = static_cast<double>(sweep.values.size()) - 0.75;
  chart.columns = kColumns;
  chart.least = kLeastWidth;
  for (const SweepNumber& number : sweep_numbers(study)) {
    ChartPanel& panel = chart.panels.emplace_back();
    panel.label = number.heading;
    panel.axis = sweep_axis(number, sweep);
    if (number.name == "nees_ratio") panel.bands.push_back({"", 1.0 / study.within, study.within});
    for (std::size_t c = 0; c < sweep.curves.size(); ++c) add_curve(sweep, c, number, panel.marks);
    figure.data.push_back({figure.name + "_" + number.name + ".csv", sweep_data(sweep, number)});
  }
  return figure;
}

std::vector<Figure> sweep_figures(const StudyAnalysis& study) {
  std::vector<Figure> figures;
  for (const Sweep& sweep : sweeps_of(study)) figures.push_back(sweep_figure(study, sweep));
  return figures;
}

TextTable sweep_table(const StudyAnalysis& study, const Sweep& sweep) {
  TextTable table;
  table.keys = 2;
  const std::vector<SweepNumber> numbers = sweep_numbers(study);
  for (const SweepCurve& curve : sweep.curves) {
    for (std::size_t k = 0; k < sweep.values.size(); ++k) {
      if (curve.cells[k] == nullptr) continue;
      std::vector<TextTable::Entry> row = {{"filter", curve.name, Align::left},
                                           {sweep.option, sweep.values[k]}};
      for (const SweepNumber& number : numbers) {
        row.push_back(
            {number.heading + " [" + level_text(study.level) + "]", number.text(*curve.cells[k])});
      }
      table.add(row);
    }
  }
  return table;
}

std::vector<Section> sweep_sections(const StudyAnalysis& study) {
  const std::vector<Sweep> sweeps = sweeps_of(study);
  if (sweeps.empty()) return {};
  std::string options;
  for (const Sweep& sweep : sweeps) {
    append_part(options,
                sweep.option + " from " + sweep.values.front() + " to " + sweep.values.back(),
                "; ");
  }
  Section section = section_of("sweep", {{"options", options}});
  for (const Sweep& sweep : sweeps) section.add(name_of_sweep(sweep), sweep_table(study, sweep));
  section.add_notes("notes", {{"level", level_text(study.level)}});
  return {section};
}

/// Every score of the cells of all sweeps, with the value of the option.
Frame sweeps_frame(const StudyAnalysis& study) {
  Frame frame;
  for (const Sweep& sweep : sweeps_of(study)) {
    for (const SweepCurve& curve : sweep.curves) {
      for (std::size_t k = 0; k < sweep.values.size(); ++k) {
        const CellAnalysis* cell = curve.cells[k];
        if (cell == nullptr) continue;
        Frame::Row row = {{"option", sweep.option},
                          {"value", sweep.values[k]},
                          {"curve", curve.name},
                          {"cell", cell->label},
                          {"nees_ratio", "1", cell->verdict.ratio_estimate()},
                          {"nees_ratio_lower", "1", cell->verdict.ratio().lower},
                          {"nees_ratio_upper", "1", cell->verdict.ratio().upper}};
        for (const Score& score : all_scores()) {
          const std::string name = score.name;
          const Interval interval = cell->interval_of(name);
          row.emplace_back(name, score.units, cell->over_runs(name).mean);
          row.emplace_back(name + "_lower", score.units, interval.lower);
          row.emplace_back(name + "_upper", score.units, interval.upper);
        }
        frame.add(row);
      }
    }
  }
  return frame;
}

}  // namespace

Metric sweep_metric() {
  return {.sections = sweep_sections,
          .figures = sweep_figures,
          .files = {{"sweeps.csv", sweeps_frame}}};
}

}  // namespace montecarta::analysis
