// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/joint_figure.hpp"

#include "analysis/metrics/joint_nees.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/output/panel.hpp"

#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

namespace montecarta {
namespace {

/// The ends of the band, which is the narrower the larger the map is; one band for each number of
/// runs that it is for.
void add_band(const CellAnalysis& cell, double level, bool is_first, Panel& panel) {
  std::vector<double> lower, upper;
  for (const Interval& bounds : cell.get<JointConsistency>().bounds) {
    lower.push_back(bounds.lower);
    upper.push_back(bounds.upper);
  }
  panel.curves.push_back(
      {is_first ? level_text(level) + " band" : "", kYardstickStyle, std::move(lower)});
  panel.curves.push_back({"", kYardstickStyle, std::move(upper)});
}

}  // namespace

Figure joint_figure(const StudyAnalysis& study) {
  Figure figure{"joint_nees", "Is the filter right about pose and map together?", ""};
  figure.sentence =
      "Normalised error squared of the vehicle and all landmarks at once, for each component: 1 is "
      "right, and a curve between the dashed lines at every stored scan belongs to a filter whose "
      "covariance, with all its correlations, fits its errors. It finds fault with a filter sooner "
      "than the pose alone, since every landmark is a witness.";
  Panel panel{"joint_nees", "joint NEES per component", {}, {}, Scale::automatic};
  std::set<std::vector<std::uint32_t>> runs;
  for (std::size_t i = 0; i < study.cells.size(); ++i) {
    const CellAnalysis& cell = study.cells[i];
    if (cell.get<JointConsistency>().verdict == Verdict::untested) continue;
    panel.curves.push_back({cell.label, i, cell.get<JointConsistency>().average});
    if (runs.insert(cell.get<JointConsistency>().runs).second)
      add_band(cell, study.level, runs.size() == 1, panel);
  }
  add_panels({panel}, study.joint_times, figure);
  return figure;
}

}  // namespace montecarta
