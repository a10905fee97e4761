// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/joint_table.hpp"

#include "analysis/metrics/joint_nees.hpp"
#include "analysis/output/named_rows.hpp"
#include "analysis/output/number_text.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta {
namespace {

bool is_judged(const CellAnalysis& cell) {
  return cell.get<JointConsistency>().verdict != Verdict::untested;
}

std::string words_of(Verdict verdict) {
  Consistency found;
  found.verdict = verdict;
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
          words_of(joint.verdict)};
}

}  // namespace

bool has_joint_nees(const StudyAnalysis& study) {
  return std::ranges::any_of(study.cells, is_judged);
}

TextTable joint_table(const StudyAnalysis& study) {
  TextTable table;
  if (!has_joint_nees(study)) return table;
  table.headings = {{"cell", Align::left}, {"components at the end"},
                    {"NEES / component"},  {"right"},
                    {"farthest from 1"},   {"pose and map"}};
  for (const CellAnalysis& cell : study.cells) {
    if (is_judged(cell)) table.rows.push_back(row_of(cell, study.joint_times));
  }
  return table;
}

std::vector<std::string> joint_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  if (has_joint_nees(study)) {
    notes.push_back(
        "Pose and map together: the squared error of the vehicle and of all landmarks at once, "
        "measured by the covariance that the filter has of them all, for each component (1 is "
        "right, more is too sure of itself). It also sees wrong correlations, which no part by "
        "itself shows. 'Right' is where a right filter stays at all " +
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

}  // namespace montecarta
