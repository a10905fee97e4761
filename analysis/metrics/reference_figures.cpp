// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/cell_panels.hpp"
#include "analysis/metrics/particle_curves.hpp"
#include "analysis/metrics/reference_analysis.hpp"
#include "analysis/metrics/reference_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace montecarta::analysis {
namespace {

/// Nearer than this a reference cannot tell [m]: satellite positions are good to a centimetre.
constexpr double kLeastError = 0.01;
constexpr double kTwoDecades = 100.0;

/// One axis for all panels, which begins at kLeastError where it is logarithmic.
Scale scale_of(const std::vector<Panel>& panels) {
  double least = std::numeric_limits<double>::infinity(), greatest = 0.0;
  for (const Panel& panel : panels) {
    for (const Curve& curve : panel.curves) {
      for (const double value : curve.values) {
        if (std::isnan(value)) continue;
        least = std::min(least, std::max(value, kLeastError));
        greatest = std::max(greatest, value);
      }
    }
  }
  return greatest > kTwoDecades * least ? Scale::logarithmic : Scale::from_zero;
}

/// Adds panels to a figure, which says so where there are several.
void add(const std::vector<Panel>& panels, const std::vector<double>& times, Figure& figure) {
  if (panels.size() > 1) figure.sentence += " One panel for each number of particles M.";
  add_panels(panels, times, figure);
}

}  // namespace

Figure reference_error_figure(const StudyAnalysis& study) {
  Figure figure{"reference_error", "How far from the reference over time?", ""};
  if (study.references.empty() || study.own_drives > 0) return figure;
  const JudgedReference& reference = study.references.front();
  figure.sentence = "Distance between the estimate as it stands and each fix of " + reference.name +
                    ", root mean square over runs: lower is better, but no curve can be nearer "
                    "than the reference itself is right. Peaks that all filters have are wild "
                    "fixes; a curve that climbs and stays belongs to a filter that lost the map.";
  const Panel blank{"reference_error", "distance to " + reference.name + " [m]", {}, {}, {},
                    kLeastError};
  std::vector<Panel> panels = cell_panels(study, blank, [](const CellAnalysis& cell) {
    return cell.complete == 0 ? std::vector<double>{}
                              : cell.get<ReferenceAnalyses>().front().error_over_time;
  });
  if (panels.empty()) return figure;
  const Scale scale = scale_of(panels);
  for (Panel& panel : panels) panel.scale = scale;
  add(panels, reference.times, figure);
  return figure;
}

Figure map_size_figure(const StudyAnalysis& study) {
  Figure figure{"map_size", "How does the map grow?", ""};
  figure.sentence =
      "Landmarks in the map, mean over runs (of a particle filter: over its weighted particles). "
      "It should level off where the vehicle meets known ground: a map that goes on growing there "
      "takes known landmarks for new ones.";
  const std::vector<Panel> panels =
      cell_panels(study, {"map_size", "landmarks", {}, {}, Scale::from_zero},
                  [](const CellAnalysis& cell) { return cell.over_time("map_landmarks"); });
  if (!panels.empty()) add(panels, study.times, figure);
  return figure;
}

Figure particles_figure(const StudyAnalysis& study) {
  Figure figure{"reference_particles", "Do more particles help?", ""};
  const std::vector<ParticleCurve> curves = particle_curves(study);
  if (curves.empty()) return figure;
  figure.sentence = "RMS distance to " + study.references.front().name +
                    " against the number of particles, one curve a filter: left as it stands, "
                    "right after the best turn and shift of the whole path. Points are means over "
                    "runs, bars reach from the best run to the worst, the dashed line is EKF-SLAM.";
  draw_particle_curves(curves, baseline_errors(study), figure);
  return figure;
}

std::vector<Figure> reference_figures(const StudyAnalysis& study) {
  std::vector<Figure> figures = {reference_error_figure(study), particles_figure(study),
                                 map_size_figure(study)};
  std::erase_if(figures, [](const Figure& figure) { return figure.data.empty(); });
  return figures;
}

}  // namespace montecarta::analysis
