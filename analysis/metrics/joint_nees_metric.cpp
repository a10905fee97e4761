// SPDX-License-Identifier: BSD-3-Clause
// Pose and map together.
#include "analysis/metrics/joint_nees.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/output/panel.hpp"
#include "analysis/statistics/means.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr Score kJointNeesScores[] = {
    {"joint_nees", "1", "joint NEES of pose and map per component",
     [](const MeasuredRun& run) {
       return run.has_identities ? nees_per_component(run.joint) : kNaN;
     },
     Better::neither}};

class JointNeesOverRuns final : public MetricSums {
 public:
  explicit JointNeesOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override { joint_.add(run.joint); }
  void put(CellAnalysis& cell) override {
    cell.findings.put(joint_.result(criteria_->verdict_level(), criteria_->map.identities_known,
                                    criteria_->within));
  }

 private:
  const RunCriteria* criteria_;
  JointNeesSums joint_;
};

/// At the last stored scan.
void joint_nees_numbers(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  const JointConsistency& joint = cell.get<JointConsistency>();
  const bool known = joint.verdict != Verdict::untested;
  const Interval bounds = known ? joint.bounds.back() : Interval{kNaN, kNaN};
  all.push_back({"joint_components", "1", known ? joint.dimension.back() : kNaN});
  all.push_back({"joint_nees_per_component", "1", known ? joint.average.back() : kNaN});
  all.push_back({"joint_nees_lower", "1", bounds.lower});
  all.push_back({"joint_nees_upper", "1", bounds.upper});
  all.push_back({"joint_undefined", "1", static_cast<double>(joint.undefined)});
}

bool is_judged(const CellAnalysis& cell) {
  return cell.get<JointConsistency>().verdict != Verdict::untested;
}

std::string words_of(const JointConsistency& joint, const std::vector<double>& times) {
  Consistency found;
  found.verdict = joint.verdict;
  found.within = joint.within;
  if (const auto row = joint.highest_row) found.highest = {ratio_of_row(joint, *row), times[*row]};
  if (const auto row = joint.lowest_row) found.lowest = {ratio_of_row(joint, *row), times[*row]};
  found.more_runs = joint.more_runs;
  return in_words(found);
}

/// The stored scan at which the average is farthest from 1.
std::size_t worst_row(const JointConsistency& joint) {
  const auto distance = [](double average) {
    return std::isnan(average) ? -1.0 : std::abs(std::log(average));
  };
  return static_cast<std::size_t>(std::ranges::max_element(joint.average, {}, distance) -
                                  joint.average.begin());
}

std::vector<std::string> row_of(const CellAnalysis& cell, const std::vector<double>& times) {
  const JointConsistency& joint = cell.get<JointConsistency>();
  const std::size_t worst = worst_row(joint);
  return {cell.label,
          readable(joint.dimension.back()),
          readable(joint.average.back()),
          interval_text(joint.bounds.back()),
          readable(joint.average[worst]) + " at " + readable(times[worst]) + " s",
          words_of(joint, times)};
}

/// Whether any cell was judged by its joint estimates.
bool has_joint_nees(const StudyAnalysis& study) {
  return std::ranges::any_of(study.cells, is_judged);
}

/// One row a cell that has joint estimates: is it consistent in pose and map together? Without rows
/// where none has.
TextTable joint_table(const StudyAnalysis& study) {
  TextTable table;
  if (!has_joint_nees(study)) return table;
  table.headings = {{"cell", Align::left}, {"components at the end"}, {"NEES / component"},
                    {"expected within"},   {"farthest from 1"},       {"pose and map"}};
  for (const CellAnalysis& cell : study.cells) {
    if (is_judged(cell)) table.rows.push_back(row_of(cell, study.joint_times));
  }
  return table;
}

/// How to read it, a sentence each, or why there are no numbers; nothing where none are stored.
std::vector<std::string> joint_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  if (has_joint_nees(study)) {
    notes.push_back(
        "Pose and map together: the squared error of the vehicle and of all landmarks at once, "
        "measured by the covariance that the filter has of them all, for each component (1 is "
        "expected, more is overconfident). It also sees wrong correlations, which no part by "
        "itself shows. It is consistent where the average of every stored scan is shown to be "
        "within the margin. 'Expected within' is where a consistent filter stays at all " +
        std::to_string(study.joint_times.size()) + " stored scans with a probability of " +
        percent(study.level) + " at least.");
  }
  for (const CellAnalysis& cell : study.cells) {
    const JointConsistency& joint = cell.get<JointConsistency>();
    if (!joint.missing.empty()) {
      notes.push_back(cell.label + ": pose and map together are not judged, since " +
                      joint.missing + ".");
    } else if (joint.undefined > 0) {
      notes.push_back(cell.label + ": of " + std::to_string(joint.samples) + " joint covariances " +
                      std::to_string(joint.undefined) +
                      " were not a number or not positive definite (left out of the average).");
    }
  }
  return notes;
}

/// One row a cell and stored scan: joint NEES per component with its bounds.
void write_joint_nees(const StudyAnalysis& study, const std::filesystem::path& path) {
  NamedRows file(path);
  for (const CellAnalysis& cell : study.cells) {
    if (!is_judged(cell)) continue;
    const JointConsistency& joint = cell.get<JointConsistency>();
    for (std::size_t k = 0; k < joint.average.size(); ++k) {
      file.row({{"cell", cell.label}}, {{"time", "s", study.joint_times[k]},
                                        {"runs", "1", static_cast<double>(joint.runs[k])},
                                        {"components", "1", joint.dimension[k]},
                                        {"nees_per_component", "1", joint.average[k]},
                                        {"lower", "1", joint.bounds[k].lower},
                                        {"upper", "1", joint.bounds[k].upper}});
    }
  }
  file.close();
}

/// The ends of the band, which is the narrower the larger the map is; one band for each number of
/// runs that it is for.
void add_band(const CellAnalysis& cell, double level, bool is_first, Panel& panel) {
  std::vector<double> lower, upper;
  for (const Interval& bounds : cell.get<JointConsistency>().bounds) {
    lower.push_back(bounds.lower);
    upper.push_back(bounds.upper);
  }
  panel.curves.push_back(
      {is_first ? level_text(level) + " band" : "", kReferenceStyle, std::move(lower)});
  panel.curves.push_back({"", kReferenceStyle, std::move(upper)});
}

/// NEES of pose and map together at the scans at which joint estimates are stored, with the band of
/// a consistent filter. Without data where no cell was judged by them.
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

std::vector<Section> joint_nees_sections(const StudyAnalysis& study) {
  Section section{"joint_nees", "Pose and map together"};
  section.add("joint_nees", joint_table(study));
  section.add(joint_notes(study));
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
          .files = {{"joint_nees.csv", has_joint_nees, write_joint_nees}}};
}

}  // namespace montecarta::analysis
