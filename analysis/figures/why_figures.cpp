// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/why_figures.hpp"

#include "analysis/figures/cell_panels.hpp"
#include "analysis/output/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace montecarta {
namespace {

std::vector<double> in_percent(std::vector<double> shares) {
  for (double& share : shares) share *= 100.0;
  return shares;
}

/// Where the worst ratio of a right filter lies, by the cell with the fewest runs.
Band right_ratios(const StudyAnalysis& study) {
  std::size_t fewest = study.runs_here;
  for (const CellAnalysis& cell : study.cells) {
    if (cell.anatomy) fewest = std::min(fewest, cell.complete);
  }
  return {"right filter", 1.0, right_worst_ratio(fewest, study.level)};
}

/// Where white innovations stay: one band for each number of pairs of scans; where there are none
/// so far apart, no band.
std::vector<Band> white_bands(const StudyAnalysis& study) {
  std::set<double> bounds;
  for (const CellAnalysis& cell : study.cells) {
    if (cell.innovations && std::isfinite(cell.innovations->bound))
      bounds.insert(cell.innovations->bound);
  }
  std::vector<Band> bands;
  for (const double bound : bounds) {
    bands.push_back(
        {bands.empty() ? level_text(study.level) + " band of white ones" : "", -bound, bound});
  }
  return bands;
}

}  // namespace

Figure survival_figure(const StudyAnalysis& study) {
  Figure figure{"survival", "How long does a run stay right?", ""};
  figure.sentence =
      "Share of the runs that still know how wrong they are, each judged by its own NEES: a run is "
      "lost where that stays above the band of a single run for 5 s at 5 Hz, or where it fails. A "
      "right filter loses a few runs by chance.";
  const CellValues share = [](const CellAnalysis& cell) {
    return cell.survival ? in_percent(cell.survival->share) : std::vector<double>{};
  };
  add_panels(
      cell_panels(study, {"runs_right", "runs still right [%]", {}, {}, Scale::percent}, share),
      study.times, figure);
  return figure;
}

Figure why_figure(const StudyAnalysis& study) {
  Figure figure{"why", "What is wrong, scatter or bias?", ""};
  figure.sentence =
      "Above: how many times larger squared errors are than the variance the filter believes, in "
      "the direction where that is worst. Below: how much of ANEES comes from errors that all runs "
      "share (bias); the rest is scatter that the filter does not know of.";
  const CellValues ratio = [](const CellAnalysis& cell) {
    return cell.anatomy ? cell.anatomy->worst_ratio : std::vector<double>{};
  };
  const CellValues bias = [](const CellAnalysis& cell) {
    return cell.anatomy ? in_percent(cell.anatomy->bias_share) : std::vector<double>{};
  };
  std::vector<Panel> panels = cell_panels(
      study, {"worst_variance_ratio", "worst variance ratio", {}, {}, Scale::automatic}, ratio);
  for (Panel& panel : panels) panel.bands.push_back(right_ratios(study));
  for (Panel& panel :
       cell_panels(study, {"bias_share", "bias in ANEES [%]", {}, {}, Scale::percent}, bias)) {
    panels.push_back(std::move(panel));
  }
  add_panels(panels, study.times, figure);
  return figure;
}

Figure innovation_figure(const StudyAnalysis& study) {
  Figure figure{"nis", "Do measurements surprise the filter?", ""};
  figure.sentence =
      "Normalised innovation squared per component, mean over runs: near 1 the filter expects its "
      "measurements as well as it says; above, they surprise it. This test needs no truth, and a "
      "filter that has lost its way may still pass it.";
  const CellValues nis = [](const CellAnalysis& cell) {
    return cell.innovations ? cell.innovations->average : std::vector<double>{};
  };
  add_panels(
      cell_panels(study, {"nis_per_component", "NIS per component", {}, {}, Scale::automatic}, nis),
      study.times, figure);
  return figure;
}

Figure whiteness_figure(const StudyAnalysis& study) {
  Figure figure{"whiteness", "Does one surprise foretell the next?", ""};
  figure.sentence =
      "Correlation of the normalised innovations squared of scans that lie so many scans apart, "
      "mean over runs: inside of the grey band at every distance the innovations are white, one "
      "tells nothing of the next; a curve above it belongs to a filter that makes the same mistake "
      "scan after scan.";
  const CellValues correlation = [](const CellAnalysis& cell) {
    return cell.innovations ? cell.innovations->autocorrelation : std::vector<double>{};
  };
  std::vector<Panel> panels = cell_panels(
      study, {"whiteness", "correlation of NIS", {}, {}, Scale::around_zero}, correlation);
  for (Panel& panel : panels) panel.bands = white_bands(study);
  std::vector<double> lags(kInnovationLags);
  std::iota(lags.begin(), lags.end(), 1.0);
  figure.chart.x_label = "scans apart";
  add_panels(panels, lags, figure);
  return figure;
}

std::vector<Figure> why_figures(const StudyAnalysis& study) {
  std::vector<Figure> figures = {survival_figure(study), why_figure(study),
                                 innovation_figure(study), whiteness_figure(study)};
  std::erase_if(figures, [](const Figure& figure) { return figure.data.empty(); });
  return figures;
}

}  // namespace montecarta
