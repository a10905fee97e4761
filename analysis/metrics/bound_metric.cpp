// SPDX-License-Identifier: BSD-3-Clause
// The Cramer-Rao bound of the study, and how near cells come to it.
#include "analysis/metrics/cramer_rao.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/csv_file.hpp"

namespace montecarta::analysis {
namespace {

void bound_numbers(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  all.push_back({"position_efficiency", "1", cell.get<Efficiency>().position});
  all.push_back({"heading_efficiency", "1", cell.get<Efficiency>().heading});
  all.push_back({"map_efficiency", "1", cell.get<Efficiency>().map});
}

std::string paths_of(const CramerRaoBound& bound) {
  return bound.runs == 1 ? "of the path"
                         : "of " + std::to_string(bound.runs) +
                               " worlds (root of the mean of their squares, each given its world)";
}

/// One row a scan: the Cramer-Rao bound of position and heading.
void write_bound(const StudyAnalysis& study, const std::filesystem::path& path) {
  CsvFile file(path);
  file.row(std::vector<std::string>{"time [s]", "position_bound [m]", "heading_bound [rad]"});
  for (std::size_t s = 0; s < study.bound.position.size(); ++s) {
    file.row(std::vector<double>{study.times[s], study.bound.position[s], study.bound.heading[s]});
  }
  file.close();
}

}  // namespace

std::vector<std::string> bound_notes(const CramerRaoBound& bound) {
  if (bound.empty()) {
    return {"There is no Cramer-Rao bound and no efficiency, since " + bound.missing + "."};
  }
  if (!bound.is_bound) {
    return {
        "There is no efficiency: noise moves the vehicle, so that every run has a path of its "
        "own, and a filter that knows the law of the paths may have smaller errors than the "
        "recursion along each of them. The linearised reference is that recursion (a Kalman "
        "filter with all Jacobians at the truth), root of the mean of squares over " +
        std::to_string(bound.runs) + " paths; it is no bound."};
  }
  return {"Efficiency is the Cramer-Rao bound " + paths_of(bound) +
          ", the least error that any filter without bias can have that knows which landmark is "
          "which, divided by the error of the filter (root mean squares over all scans; of the "
          "position, in the table of maps of the landmarks): 100 % is as good as can be. A filter "
          "with a bias may come out above."};
}

Metric bound_metric() {
  return {.add_numbers = bound_numbers,
          .files = {{"bound.csv", [](const StudyAnalysis& study) { return !study.bound.empty(); },
                     write_bound}}};
}

}  // namespace montecarta::analysis
