// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/map_files.hpp"

#include "analysis/metrics/map_errors.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/named_rows.hpp"

#include <string>

namespace montecarta {

void write_bound(const StudyAnalysis& study, const std::filesystem::path& path) {
  CsvFile file(path);
  file.row(std::vector<std::string>{"time [s]", "position_bound [m]", "heading_bound [rad]"});
  for (std::size_t s = 0; s < study.bound.position.size(); ++s) {
    file.row(std::vector<double>{study.times[s], study.bound.position[s], study.bound.heading[s]});
  }
  file.close();
}

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

}  // namespace montecarta
