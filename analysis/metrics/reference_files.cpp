// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/reference_analysis.hpp"
#include "analysis/metrics/reference_report.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/statistics/means.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace montecarta::analysis {
namespace {

void add(const std::string& name, const std::string& units, const Spread& spread,
         std::vector<NamedNumber>& all) {
  all.push_back({name + "_mean", units, spread.summary.mean});
  all.push_back({name + "_standard_error", units, spread.summary.standard_error()});
  all.push_back({name + "_median", units, spread.median});
  all.push_back({name + "_least", units, spread.least});
  all.push_back({name + "_greatest", units, spread.greatest});
}

/// Of the map, which is the same against every reference.
bool is_of_the_map(const std::string& name) {
  return name.starts_with("map_") || name.starts_with("beacon");
}

}  // namespace

std::vector<NamedNumber> reference_numbers(const CellAnalysis& cell, std::size_t reference) {
  const ReferenceAnalysis& against = cell.get<ReferenceAnalyses>()[reference];
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  const bool judged = cell.complete == 0 || against.with_fixes() > 0;
  const std::size_t lost = against.lost() + cell.failures.size();
  std::vector<NamedNumber> all = {{"runs_failed", "1", count(cell.failures.size())},
                                  {"runs_complete", "1", count(cell.complete)},
                                  {"runs_lost", "1", judged ? count(lost) : kNaN}};
  const auto one = [&](const char* name, const char* units, double ReferenceScores::*score) {
    add(name, units, against.over_runs(score), all);
  };
  one("rms", "m", &ReferenceScores::rms);
  one("median_error", "m", &ReferenceScores::median);
  one("gated_rms", "m", &ReferenceScores::gated_rms);
  one("gated_share", "1", &ReferenceScores::gated_share);
  one("aligned_rms", "m", &ReferenceScores::aligned_rms);
  one("aligned_median_error", "m", &ReferenceScores::aligned_median);
  one("aligned_gated_rms", "m", &ReferenceScores::aligned_gated_rms);
  one("aligned_gated_share", "1", &ReferenceScores::aligned_gated_share);
  one("heading_rmse", "rad", &ReferenceScores::heading_rmse);
  for (const Score& score : all_scores()) {
    if (!is_of_the_map(score.name)) continue;
    add(score.name, score.units, cell.known_over_runs(score.name), all);
  }
  all.push_back({"cpu_seconds_mean", "s", cell.over_runs("cpu_seconds").mean});
  return all;
}

void write_references(const StudyAnalysis& study, const std::filesystem::path& path) {
  NamedRows file(path);
  for (const CellAnalysis& cell : study.cells) {
    for (std::size_t r = 0; r < cell.get<ReferenceAnalyses>().size(); ++r) {
      file.row(
          {{"cell", cell.label}, {"filter", cell.filter}, {"reference", study.references[r].name}},
          reference_numbers(cell, r));
    }
  }
  file.close();
}

void write_reference_errors(const StudyAnalysis& study, const std::filesystem::path& path) {
  CsvFile file(path);
  std::vector<std::string> headings = {"time [s]"};
  std::vector<const std::vector<double>*> columns;
  for (const CellAnalysis& cell : study.cells) {
    if (cell.complete == 0) continue;
    headings.push_back(cell.label + " [m]");
    columns.push_back(&cell.get<ReferenceAnalyses>().front().error_over_time);
  }
  file.row(headings);
  const std::vector<double>& times = study.references.front().times;
  for (std::size_t f = 0; f < times.size(); ++f) {
    std::vector<double> numbers = {times[f]};
    for (const auto* column : columns) numbers.push_back((*column)[f]);
    file.row(numbers);
  }
  file.close();
}

}  // namespace montecarta::analysis
