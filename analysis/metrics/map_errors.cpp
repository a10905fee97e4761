// SPDX-License-Identifier: BSD-3-Clause
// Distances of the landmarks of the final maps from their true positions.
#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_report.hpp"
#include "analysis/study/efficiency.hpp"
#include "analysis/study/map_error_sums.hpp"
#include "engine/text/list_text.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {
namespace {

template <double MapScores::*kValue>
double of_map(const MeasuredRun& run) {
  return run.map ? (*run.map).*kValue : kNaN;
}

template <double Gospa::*kValue>
double of_map(const MeasuredRun& run) {
  return run.map ? run.map->gospa.*kValue : kNaN;
}

constexpr Score kMapScores[] = {
    {"landmark_rms", "m", "RMS error of the landmarks in the final map", of_map<&MapScores::rms>},
    {"landmark_deviation", "m", "RMS deviation that the filter claims of these landmarks",
     of_map<&MapScores::deviation>},
    {"landmark_nees", "1", "NEES of a landmark in the final map, mean over landmarks",
     of_map<&MapScores::nees>},
    {"gospa", "m", "GOSPA of the final map", of_map<&Gospa::distance>},
    {"gospa_localisation", "m", "localisation part of GOSPA", of_map<&Gospa::localisation>},
    {"landmarks_missed", "1", "landmarks missed by the final map", of_map<&Gospa::missed>},
    {"landmarks_spurious", "1", "spurious landmarks of the final map", of_map<&Gospa::spurious>},
};

class MapOverRuns final : public MergedSums<MapOverRuns> {
 public:
  explicit MapOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override { map_.add(run.map); }
  void put(CellAnalysis& cell) override {
    cell.findings.put(map_.result(criteria_->level, criteria_->map));
  }
  static constexpr auto parts() { return std::tuple(added(&MapOverRuns::map_)); }

 private:
  const RunCriteria* criteria_;
  MapErrorSums map_;
};

void map_numbers(const CellAnalysis& cell, Frame::Row& all) {
  all.emplace_back("landmarks_undefined", "1",
                   static_cast<double>(cell.get<MapErrors>().undefined));
}

std::vector<TextTable::Entry> map_error_row(const CellAnalysis& cell) {
  const auto text = [&](const char* score) {
    const Summary summary = cell.over_runs(score);
    return with_error(summary.mean, summary.standard_error());
  };
  return {{"landmark RMSE [m]", text("landmark_rms")},
          {"efficiency", percent(cell.get<Efficiency>().map)},
          {"landmark NEES", text("landmark_nees")},
          {"landmarks inside", percent(cell.get<MapErrors>().share_inside())},
          {"GOSPA [m]", text("gospa")},
          {"of it errors [m]", text("gospa_localisation")},
          {"missed", text("landmarks_missed")},
          {"spurious", text("landmarks_spurious")}};
}

/// {reason} Returns the labels of the cells that lack map errors for this reason: "a, b".
std::map<std::string, std::string> cells_without_map_errors(const StudyAnalysis& study) {
  std::map<std::string, std::string> cells;
  for (const CellAnalysis& cell : study.cells) {
    if (cell.get<MapErrors>().missing.empty()) continue;
    std::string& labels = cells[cell.get<MapErrors>().missing];
    append_part(labels, cell.label);
  }
  return cells;
}

/// Returns whether any cell of a simulation has final maps to judge.
bool has_map_errors(const StudyAnalysis& study) {
  return std::ranges::any_of(
      study.cells, [](const CellAnalysis& cell) { return cell.get<MapErrors>().missing.empty(); });
}

/// Adds notes on how to read the table, or the reason why there are no numbers.
void add_map_notes(const StudyAnalysis& study, Section& section) {
  if (has_map_errors(study)) {
    section.add_notes("notes", {{"level", level_text(study.level)},
                                {"penalty", readable(0.5 * kGospaCutoff * kGospaCutoff)},
                                {"cutoff", readable(kGospaCutoff, 1)}});
  }
  if (study.has_truth && study.beacons > 0) {
    for (const auto& [reason, cells] : cells_without_map_errors(study)) {
      section.add_notes("missing", {{"cells", cells}, {"reason", reason}});
    }
  }
  for (const CellAnalysis& cell : study.cells) {
    const std::uint64_t undefined = cell.get<MapErrors>().undefined;
    if (undefined == 0) continue;
    section.add_notes("undefined",
                      {{"cell", cell.label}, {"landmarks", std::to_string(undefined)}});
  }
}

/// Makes a file with one row for each cell and landmark: error and NEES over runs, with the bounds
/// of that NEES.
Frame landmarks_frame(const StudyAnalysis& study) {
  Frame frame;
  for (const CellAnalysis& cell : study.cells) {
    const std::vector<LandmarkErrors>& landmarks = cell.get<MapErrors>().landmarks;
    for (std::size_t l = 0; l < landmarks.size(); ++l) {
      const LandmarkErrors& one = landmarks[l];
      frame.add({{"cell", cell.label},
                 {"landmark", std::to_string(l)},
                 {"runs", "1", static_cast<double>(one.runs)},
                 {"runs_with_nees", "1", static_cast<double>(one.valid)},
                 {"rms", "m", one.rms},
                 {"anees", "1", one.anees},
                 {"lower", "1", one.bounds.lower},
                 {"upper", "1", one.bounds.upper}});
    }
  }
  return frame;
}

/// Text of the range of the landmark errors or, if identities are unknown, of GOSPA.
std::string map_summary(const StudyAnalysis& study) {
  const NumberText metres = [](double value) { return readable(value) + " m"; };
  const auto range_of = [&](const char* score) {
    return range_over_cells(
        study, [&](const CellAnalysis& cell) { return cell.known_over_runs(score).summary.mean; },
        metres);
  };
  const std::string rms = range_of("landmark_rms");
  return rms == "-" ? "GOSPA " + range_of("gospa") : "landmark RMSE " + rms;
}

std::vector<Section> map_sections(const StudyAnalysis& study) {
  Section section = section_of("map_errors");
  if (has_map_errors(study)) section.add("map_errors", cell_table(study, map_error_row));
  add_map_notes(study, section);
  if (section.blocks.empty()) return {};
  section.summary = map_summary(study);
  return {section};
}

}  // namespace

Metric map_errors_metric() {
  return {.scores = kMapScores,
          .sums = make_sums<MapOverRuns>,
          .add_numbers = map_numbers,
          .sections = map_sections,
          .files = {{"landmarks.csv", landmarks_frame}}};
}

}  // namespace montecarta::analysis
