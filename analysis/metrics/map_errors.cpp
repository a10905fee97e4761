// SPDX-License-Identifier: BSD-3-Clause
// How far final maps are from the true landmarks.
#include "analysis/metrics/map_errors.hpp"

#include "analysis/metrics/cell_range.hpp"
#include "analysis/metrics/cramer_rao.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/spread.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

namespace montecarta::analysis {

double MapErrors::share_inside() const {
  double inside = 0.0, tested = 0.0;
  for (const LandmarkErrors& one : landmarks) {
    if (one.valid == 0) continue;
    tested += 1.0;
    inside += one.anees >= one.bounds.lower && one.anees <= one.bounds.upper ? 1.0 : 0.0;
  }
  return inside / tested;
}

void MapErrorSums::add(const std::optional<MapScores>& run) {
  ++n_runs_;
  if (!run) return;
  ++n_maps_;
  undefined_ += run->undefined;
  landmarks_.resize(run->landmarks.size());
  for (std::size_t l = 0; l < landmarks_.size(); ++l) {
    const LandmarkScore& score = run->landmarks[l];
    if (!score.in_map) continue;
    Sums& sums = landmarks_[l];
    sums.squares += score.squared_error;
    ++sums.runs;
    if (!std::isfinite(score.nees)) continue;
    sums.nees += score.nees;
    ++sums.valid;
  }
}

std::string MapErrorSums::reason(bool known) const {
  if (!known) return "nobody knows where the landmarks are";
  if (n_runs_ == 0) return "no run is complete";
  if (n_maps_ == 0) {
    return "maps are not stored, or not whole: add final_map to record.columns (and enlarge "
           "record.map_rows where it is given)";
  }
  if (n_maps_ < n_runs_) {
    return "the maps of " + std::to_string(n_runs_ - n_maps_) +
           " runs are not whole: enlarge record.map_rows";
  }
  return {};
}

MapErrors MapErrorSums::result(double level, bool known) const {
  MapErrors errors;
  errors.missing = reason(known);
  if (!errors.missing.empty()) return errors;
  if (landmarks_.empty()) return errors;
  errors.undefined = undefined_;
  for (const Sums& sums : landmarks_) {
    LandmarkErrors one{.runs = sums.runs, .valid = sums.valid};
    if (sums.runs > 0) one.rms = std::sqrt(sums.squares / sums.runs);
    if (sums.valid > 0) {
      one.anees = sums.nees / sums.valid;
      one.bounds = nees_bounds(sums.valid, 2, level);
    }
    errors.landmarks.push_back(one);
  }
  return errors;
}

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
    cell.findings.put(map_.result(criteria_->level, criteria_->map.known));
  }
  static constexpr auto parts() { return std::tuple(added(&MapOverRuns::map_)); }

 private:
  const RunCriteria* criteria_;
  MapErrorSums map_;
};

void map_numbers(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  all.push_back({"landmarks_undefined", "1", static_cast<double>(cell.get<MapErrors>().undefined)});
}

std::string text_of(const CellAnalysis& cell, std::string_view score) {
  const Summary summary = cell.over_runs(score);
  return with_error(summary.mean, summary.standard_error());
}

std::vector<TextTable::Entry> row_of(const CellAnalysis& cell) {
  return {{"cell", cell.label, Align::left},
          {"landmark RMSE [m]", text_of(cell, "landmark_rms")},
          {"efficiency", percent(cell.get<Efficiency>().map)},
          {"landmark NEES", text_of(cell, "landmark_nees")},
          {"landmarks inside", percent(cell.get<MapErrors>().share_inside())},
          {"GOSPA [m]", text_of(cell, "gospa")},
          {"of it errors [m]", text_of(cell, "gospa_localisation")},
          {"missed", text_of(cell, "landmarks_missed")},
          {"spurious", text_of(cell, "landmarks_spurious")}};
}

/// Reason, and the labels of the cells it is true of: "a, b".
std::map<std::string, std::string> cells_without_map_errors(const StudyAnalysis& study) {
  std::map<std::string, std::string> cells;
  for (const CellAnalysis& cell : study.cells) {
    if (cell.get<MapErrors>().missing.empty()) continue;
    std::string& labels = cells[cell.get<MapErrors>().missing];
    labels += (labels.empty() ? "" : ", ") + cell.label;
  }
  return cells;
}

/// Whether any cell of a simulation has final maps to judge.
bool has_map_errors(const StudyAnalysis& study) {
  return std::ranges::any_of(
      study.cells, [](const CellAnalysis& cell) { return cell.get<MapErrors>().missing.empty(); });
}

/// One row for each cell; no rows if no cell has a map.
TextTable map_error_table(const StudyAnalysis& study) {
  TextTable table;
  if (!has_map_errors(study)) return table;
  for (const CellAnalysis& cell : study.cells) table.add(row_of(cell));
  return table;
}

/// Adds how to read the table, or why there are no numbers.
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

/// One row for each cell and landmark: error and NEES over runs, with the bounds of that NEES.
void write_landmarks(const StudyAnalysis& study, const std::filesystem::path& path) {
  NamedRows file(path);
  for (const CellAnalysis& cell : study.cells) {
    for (std::size_t l = 0; l < cell.get<MapErrors>().landmarks.size(); ++l) {
      const LandmarkErrors& one = cell.get<MapErrors>().landmarks[l];
      file.row({{"cell", cell.label}, {"landmark", std::to_string(l)}},
               {{"runs", "1", static_cast<double>(one.runs)},
                {"runs_with_nees", "1", static_cast<double>(one.valid)},
                {"rms", "m", one.rms},
                {"anees", "1", one.anees},
                {"lower", "1", one.bounds.lower},
                {"upper", "1", one.bounds.upper}});
    }
  }
  file.close();
}

/// Range of the landmark errors or, with unknown identities, of GOSPA.
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
  section.add("map_errors", map_error_table(study));
  add_map_notes(study, section);
  if (section.blocks.empty()) return {};
  section.summary = map_summary(study);
  return {section};
}

}  // namespace

Metric map_metric() {
  return {.scores = kMapScores,
          .sums = make_sums<MapOverRuns>,
          .add_numbers = map_numbers,
          .sections = map_sections,
          .files = {{"landmarks.csv", has_map_errors, write_landmarks}}};
}

}  // namespace montecarta::analysis
