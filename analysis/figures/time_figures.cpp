// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/time_figures.hpp"

#include "analysis/figures/panel.hpp"
#include "analysis/output/number_text.hpp"
#include "engine/numbers/angle.hpp"

#include <algorithm>
#include <functional>
#include <set>

namespace montecarta {
namespace {

/// The values of a cell that a panel shows; empty where it has none.
using ValuesOf = std::function<std::vector<double>(const CellAnalysis&)>;

/// A cell keeps its colour in every figure.
std::vector<Curve> curves(const StudyAnalysis& study, const ValuesOf& values_of) {
  std::vector<Curve> found;
  for (std::size_t i = 0; i < study.cells.size(); ++i) {
    std::vector<double> values = values_of(study.cells[i]);
    if (!values.empty()) found.push_back({study.cells[i].label, i, std::move(values)});
  }
  return found;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

/// One band for each number of complete runs among the cells that are tested.
std::vector<Band> bands(const StudyAnalysis& study, std::size_t dimension) {
  std::set<std::size_t> runs;
  for (const CellAnalysis& cell : study.cells) {
    if (!cell.nees.empty()) runs.insert(cell.complete);
  }
  std::vector<Band> found;
  for (const std::size_t n : runs) {
    const Interval band = nees_bounds(n, dimension, study.level);
    found.push_back(
        {found.empty() ? level_text(study.level) + " band" : "", band.lower, band.upper});
  }
  return found;
}

Panel anees_panel(const StudyAnalysis& study, ErrorBlock block, const std::string& name,
                  const std::string& label) {
  Panel panel{name, label, {}, {}, Scale::automatic};
  std::size_t dimension = 0;
  panel.curves = curves(study, [&](const CellAnalysis& cell) {
    const NeesResult* nees = cell.find_nees(block, cell.leading);
    if (nees == nullptr) return std::vector<double>{};
    dimension = nees->series.dimension;
    return nees->series.average;
  });
  if (!panel.curves.empty()) panel.bands = bands(study, dimension);
  return panel;
}

/// A panel of distinct ancestors.
Panel ancestor_panel(const StudyAnalysis& study, const std::string& series,
                     const std::string& label) {
  const ValuesOf values = [&](const CellAnalysis& cell) { return cell.over_time(series); };
  return {series, label, curves(study, values), {}, Scale::logarithmic};
}

/// The cells' curves and, as the floor below them, the Cramer-Rao bound.
Panel error_panel(const StudyAnalysis& study, const std::string& name, const std::string& label,
                  const ValuesOf& values_of, const std::vector<double>& bound) {
  Panel panel{name, label, curves(study, values_of), {}, Scale::from_zero};
  if (!bound.empty() && !panel.curves.empty()) {
    panel.curves.push_back({"Cramer-Rao bound", kYardstickStyle, bound});
  }
  return panel;
}

}  // namespace

Figure anees_figure(const StudyAnalysis& study) {
  Figure figure{"anees", "Is the filter right about its own errors?", ""};
  figure.sentence =
      "Average normalised error squared (ANEES) of the pose over time. A curve inside the grey "
      "band belongs to a filter whose stated uncertainty fits its real errors; a curve that climbs "
      "above the band and stays there belongs to a filter that is sure of a wrong answer. The axis "
      "ends at 1000 times the band; the numbers hold every value, also of curves beyond the top.";
  add_panels({anees_panel(study, ErrorBlock::pose, "anees_pose", "ANEES of the pose")}, study.times,
             figure);
  return figure;
}

Figure anees_parts_figure(const StudyAnalysis& study) {
  Figure figure{"anees_parts", "Position or heading: which one goes wrong?", ""};
  figure.sentence =
      "The same test for position alone (two components, right around 2) and heading alone (one "
      "component, right around 1): the curve that leaves its band first shows where trouble "
      "begins.";
  add_panels({anees_panel(study, ErrorBlock::position, "anees_position", "ANEES of position"),
              anees_panel(study, ErrorBlock::heading, "anees_heading", "ANEES of heading")},
             study.times, figure);
  return figure;
}

Figure rmse_figure(const StudyAnalysis& study) {
  Figure figure{"rmse", "How large are the errors?", ""};
  figure.sentence =
      "Root mean square error over runs at each scan: lower is better. It grows while the vehicle "
      "explores and falls where it meets landmarks it knows.";
  const ValuesOf position = [](const CellAnalysis& cell) {
    return cell.over_time("position_rmse");
  };
  const ValuesOf heading = [](const CellAnalysis& cell) {
    return scaled(cell.over_time("heading_rmse"), 180.0 / kPi);
  };
  if (!study.bound.empty()) {
    figure.sentence +=
        " The dashed line is the Cramer-Rao bound: no filter without bias can stay below it, so "
        "the gap is what a better filter could gain.";
  }
  add_panels(
      {error_panel(study, "rmse_position", "position RMSE [m]", position, study.bound.position),
       error_panel(study, "rmse_heading", "heading RMSE [deg]", heading,
                   scaled(study.bound.heading, 180.0 / kPi))},
      study.times, figure);
  return figure;
}

Figure diversity_figure(const StudyAnalysis& study) {
  Figure figure{"diversity", "How many different histories survive?", ""};
  figure.sentence =
      "Distinct ancestors of the particles, mean over runs: parents in the last resampling, "
      "ancestors 10 s ago, and ancestors at the start. When few are left, the particles tell one "
      "story in many copies, and the filter cannot know how wrong that story is.";
  add_panels({ancestor_panel(study, "ancestors_last_resampling", "parents, last resampling"),
              ancestor_panel(study, "ancestors_10_s_ago", "ancestors, 10 s ago"),
              ancestor_panel(study, "ancestors_at_start", "ancestors at the start")},
             study.times, figure);
  return figure;
}

Figure ess_figure(const StudyAnalysis& study) {
  Figure figure{"ess", "How many particles still count?", ""};
  figure.sentence =
      "Effective sample size as a share of all particles, mean over runs: near 100 % all particles "
      "explain the measurements about equally well; a low share means that few carry all weight.";
  const ValuesOf share = [](const CellAnalysis& cell) {
    return scaled(cell.over_time("ess"), 100.0 / static_cast<double>(cell.particles));
  };
  add_panels({{"ess_share", "effective particles [%]", curves(study, share), {}, Scale::percent}},
             study.times, figure);
  return figure;
}

std::vector<Figure> time_figures(const StudyAnalysis& study) {
  std::vector<Figure> figures = {anees_figure(study), anees_parts_figure(study), rmse_figure(study),
                                 diversity_figure(study), ess_figure(study)};
  std::erase_if(figures, [](const Figure& figure) { return figure.data.empty(); });
  return figures;
}

}  // namespace montecarta
