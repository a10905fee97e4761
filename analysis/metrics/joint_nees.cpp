// SPDX-License-Identifier: BSD-3-Clause
// NEES of the joint estimate of pose and map.
#include "analysis/verdict/joint_nees.hpp"

#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_report.hpp"
#include "analysis/study/strips.hpp"
#include "analysis/study/verdict_table.hpp"
#include "analysis/verdict/sentence.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr Score kJointNeesScores[] = {
    {"joint_nees", "1", "joint NEES of pose and map per component",
     [](const MeasuredRun& run) {
       return run.has_identities ? nees_per_component(run.joint) : kNaN;
     },
     Better::neither}};

/// Returns the times [s] of the joint estimates.
std::vector<double> times_of(const RunCriteria& criteria) {
  std::vector<double> times;
  for (const std::uint32_t scan : criteria.joint_scans) times.push_back(criteria.times[scan]);
  return times;
}

class JointNeesOverRuns final : public MergedSums<JointNeesOverRuns> {
 public:
  explicit JointNeesOverRuns(const RunCriteria& criteria)
      : criteria_(&criteria), joint_(times_of(criteria)) {}
  void add(const MeasuredRun& run) override { joint_.add(run.joint); }
  void put(CellAnalysis& cell) override {
    const double level = criteria_->verdict_level(cell.complete + cell.failures.size());
    cell.findings.put(joint_.result(level, criteria_->map.identities_known, criteria_->within));
  }
  static constexpr auto parts() { return std::tuple(added(&JointNeesOverRuns::joint_)); }

 private:
  const RunCriteria* criteria_;
  JointNeesSums joint_;
};

/// Adds the joint NEES at the last stored scan.
void joint_nees_numbers(const CellAnalysis& cell, Frame::Row& all) {
  const JointConsistency& joint = cell.get<JointConsistency>();
  const bool known = joint.is_judged();
  const Interval bounds = known ? joint.bounds.back() : Interval{kNaN, kNaN};
  all.insert(all.end(), {{"joint_components", "1", known ? joint.dimension.back() : kNaN},
                         {"joint_nees_per_component", "1", known ? joint.average.back() : kNaN},
                         {"joint_nees_lower", "1", bounds.lower},
                         {"joint_nees_upper", "1", bounds.upper},
                         {"joint_undefined", "1", static_cast<double>(joint.undefined)}});
}

bool is_judged(const CellAnalysis& cell) { return cell.get<JointConsistency>().is_judged(); }

/// Returns the index of the stored scan at which the average is farthest from 1.
std::size_t worst_row(const JointConsistency& joint) {
  const auto distance = [](double average) {
    return std::isnan(average) ? -1.0 : std::abs(std::log(average));
  };
  return static_cast<std::size_t>(std::ranges::max_element(joint.average, {}, distance) -
                                  joint.average.begin());
}

std::vector<TextTable::Entry> joint_row(const CellAnalysis& cell,
                                        const std::vector<double>& times) {
  if (!is_judged(cell)) return {};
  const JointConsistency& joint = cell.get<JointConsistency>();
  const std::size_t worst = worst_row(joint);
  return {
      {"components at the end", readable(joint.dimension.back())},
      {"NEES / component", readable(joint.average.back())},
      {"band", interval_text(joint.bounds.back())},
      {"farthest from 1", readable(joint.average[worst]) + " at " + readable(times[worst]) + " s"},
      {"verdict", in_words(joint.verdict), Align::right, tone_of(joint.verdict)}};
}

/// Adds notes on how to read the table, or the reason why there are no numbers. Adds nothing if no
/// joint estimates are stored.
void add_joint_notes(const StudyAnalysis& study, Section& section) {
  if (std::ranges::any_of(study.cells, is_judged)) {
    section.add_notes("notes", {{"scans", std::to_string(study.joint_times.size())},
                                {"level", percent(study.level)}});
  }
  for (const CellAnalysis& cell : study.cells) {
    const JointConsistency& joint = cell.get<JointConsistency>();
    if (!joint.missing.empty()) {
      section.add_notes("missing", {{"cell", cell.label}, {"reason", joint.missing}});
    } else if (joint.undefined > 0) {
      section.add_notes("undefined", {{"cell", cell.label},
                                      {"undefined", std::to_string(joint.undefined)},
                                      {"samples", std::to_string(joint.samples)}});
    }
  }
}

/// Makes a file with one row for each cell and stored scan: joint NEES per component with its
/// bounds.
Frame joint_frame(const StudyAnalysis& study) {
  Frame frame;
  for (const CellAnalysis& cell : study.cells) {
    if (!is_judged(cell)) continue;
    const JointConsistency& joint = cell.get<JointConsistency>();
    for (std::size_t k = 0; k < joint.average.size(); ++k) {
      frame.add({{"cell", cell.label},
                 {"time", "s", study.joint_times[k]},
                 {"runs", "1", static_cast<double>(joint.runs[k])},
                 {"components", "1", joint.dimension[k]},
                 {"nees_per_component", "1", joint.average[k]},
                 {"lower", "1", joint.bounds[k].lower},
                 {"upper", "1", joint.bounds[k].upper}});
    }
  }
  return frame;
}

/// Adds the lower and the upper end of the band of a cell as two curves. The band narrows as the
/// map grows, and depends on the number of runs.
void add_band(const CellAnalysis& cell, double level, bool is_first, Panel& panel) {
  const std::vector<Interval>& bounds = cell.get<JointConsistency>().bounds;
  panel.curves.push_back({is_first ? level_text(level) + " band" : "", kReferenceStyle,
                          ends_of(bounds, &Interval::lower)});
  panel.curves.push_back({"", kReferenceStyle, ends_of(bounds, &Interval::upper)});
}

StripPanel joint_strips(const StudyAnalysis& study) {
  StripPanel panel{"joint_nees",
                   "joint NEES per component",
                   "inside the " + level_text(study.level) + " band",
                   "mean",
                   {}};
  for (const CellAnalysis& cell : study.cells) {
    if (!is_judged(cell)) continue;
    const JointConsistency& joint = cell.get<JointConsistency>();
    panel.rows.push_back(
        {cell.label, joint.average, joint.bounds, compact(mean_of_finite(joint.average))});
  }
  return panel;
}

/// Makes a figure of the NEES of pose and map together at the scans with joint estimates, with the
/// band of a consistent filter. It has no data if no cell was judged by them.
Figure joint_figure(const StudyAnalysis& study) {
  Figure figure = figure_of("joint_nees");
  const StripPanel strips = joint_strips(study);
  if (strips.rows.size() > kMostRatioCurves) {
    figure.sentence = prose("joint_nees", "strips");
    add_strips({strips}, study.joint_times, figure);
    return figure;
  }
  figure.sentence = prose("joint_nees", "curves");
  Panel panel{"joint_nees", "joint NEES per component", {}, {}, Scale::automatic};
  std::set<std::vector<std::uint32_t>> runs;
  for (std::size_t i = 0; i < study.cells.size(); ++i) {
    const CellAnalysis& cell = study.cells[i];
    if (!is_judged(cell)) continue;
    panel.curves.push_back({cell.label, i, cell.get<JointConsistency>().average});
    if (runs.insert(cell.get<JointConsistency>().runs).second)
      add_band(cell, study.level, runs.size() == 1, panel);
  }
  add_panels({panel}, study.joint_times, figure);
  return figure;
}

std::vector<Section> joint_nees_sections(const StudyAnalysis& study) {
  const CellNumber ratio = [](const CellAnalysis& cell) {
    return is_judged(cell) ? cell.get<JointConsistency>().verdict.ratio_estimate() : kNaN;
  };
  Section section = section_of("joint_nees", {{"ratios", range_over_cells(study, ratio)}});
  section.add("joint_nees", cell_table(study, [&](const CellAnalysis& cell) {
                return joint_row(cell, study.joint_times);
              }));
  add_joint_notes(study, section);
  return {section};
}

std::vector<Figure> joint_nees_figures(const StudyAnalysis& study) { return {joint_figure(study)}; }

}  // namespace

Metric joint_nees_metric() {
  return {.scores = kJointNeesScores,
          .scores_are_numbers = false,
          .sums = make_sums<JointNeesOverRuns>,
          .add_numbers = joint_nees_numbers,
          .sections = joint_nees_sections,
          .figures = joint_nees_figures,
          .files = {{"joint_nees.csv", joint_frame}}};
}

}  // namespace montecarta::analysis
