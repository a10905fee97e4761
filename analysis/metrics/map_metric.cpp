// SPDX-License-Identifier: BSD-3-Clause
// How far final maps are from the true landmarks, and what the Cramer-Rao bound says of a cell.
#include "analysis/metrics/efficiency.hpp"
#include "analysis/metrics/map_error_table.hpp"
#include "analysis/metrics/map_errors.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/statistics/means.hpp"

namespace montecarta {
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
    {"landmarks_invented", "1", "landmarks invented by the final map", of_map<&Gospa::invented>},
};

class MapOverRuns final : public MetricSums {
 public:
  explicit MapOverRuns(const Yardsticks& sticks) : sticks_(&sticks) {}
  void add(const MeasuredRun& run) override { map_.add(run.map); }
  void put(CellAnalysis& cell) override {
    cell.findings.put(map_.result(sticks_->level, sticks_->map.known));
  }

 private:
  const Yardsticks* sticks_;
  MapErrorSums map_;
};

void map_numbers(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  all.push_back({"landmarks_undefined", "1", static_cast<double>(cell.get<MapErrors>().undefined)});
}

void add_efficiency(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  all.push_back({"position_efficiency", "1", cell.get<Efficiency>().position});
  all.push_back({"heading_efficiency", "1", cell.get<Efficiency>().heading});
  all.push_back({"map_efficiency", "1", cell.get<Efficiency>().map});
}

std::vector<Section> map_sections(const StudyAnalysis& study) {
  const std::vector<std::string> notes = map_error_notes(study);
  if (notes.empty()) return {};
  Section section{"map_errors", "Map"};
  section.add("map_errors", map_error_table(study));
  section.add(notes);
  return {section};
}

}  // namespace

Metric map_metric() {
  return {.scores = kMapScores,
          .scores_are_numbers = true,
          .sums = [](const Yardsticks& sticks) -> std::unique_ptr<MetricSums> {
            return std::make_unique<MapOverRuns>(sticks);
          },
          .add_numbers = map_numbers,
          .sections = map_sections};
}

Metric bound_metric() { return {.add_numbers = add_efficiency}; }

}  // namespace montecarta
