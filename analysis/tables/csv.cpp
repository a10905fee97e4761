// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/tables/tables.hpp"

namespace montecarta::analysis {
namespace {

constexpr const char* kFailures = "failures.csv";
constexpr const char* kCells = "cells.csv";
constexpr const char* kConsistency = "consistency.csv";
constexpr const char* kRuns = "runs.csv";
std::string series_name(const std::string& label) { return "series_" + label + ".csv"; }

void write_cells(const StudyAnalysis& study, const std::filesystem::path& path) {
  NamedRows file(path);
  for (const CellAnalysis& cell : study.cells) {
    file.row({{"cell", cell.label}, {"filter", cell.filter}, {"verdict", in_words(cell.verdict)}},
             numbers_of(cell));
  }
  file.close();
}

void write_consistency(const StudyAnalysis& study, const std::filesystem::path& path) {
  NamedRows file(path);
  for (const CellAnalysis& cell : study.cells) {
    for (const NeesResult& nees : cell.nees) {
      file.row({{"cell", cell.label},
                {"error", name_of(nees.block)},
                {"covariance", name_of(nees.moments)}},
               numbers_of(cell, nees, study.level));
    }
  }
  file.close();
}

void write_runs(const StudyAnalysis& study, const std::filesystem::path& path) {
  NamedRows file(path);
  for (const CellAnalysis& cell : study.cells) {
    for (std::size_t r = 0; r < cell.runs.size(); ++r) {
      std::vector<NamedNumber> numbers;
      for (const Score& score : all_scores()) {
        numbers.push_back({score.name, score.units, cell.scores.column(score.name)[r]});
      }
      file.row({{"cell", cell.label}, {"run", std::to_string(cell.runs[r])}}, numbers);
    }
  }
  file.close();
}

void write_table(const TextTable& table, const std::filesystem::path& path) {
  CsvFile file(path);
  std::vector<std::string> headings;
  for (const auto& column : table.headings) headings.push_back(column.text);
  file.row(headings);
  for (const auto& row : table.rows) file.row(row);
  file.close();
}

void write_series(const StudyAnalysis& study, const CellAnalysis& cell,
                  const std::filesystem::path& path) {
  const auto all = series_of(cell);
  CsvFile file(path);
  std::vector<std::string> headings = {"time [s]"};
  for (const NamedSeries& series : all) headings.push_back(heading(series.name, series.units));
  file.row(headings);
  for (std::size_t s = 0; s < study.times.size() && !all.empty(); ++s) {
    std::vector<double> numbers = {study.times[s]};
    for (const NamedSeries& series : all) numbers.push_back(series.values[s]);
    file.row(numbers);
  }
  file.close();
}

}  // namespace

std::vector<std::string> csv_names(const std::vector<std::string>& labels) {
  std::vector<std::string> names = {kFailures, kCells, kConsistency, kRuns};
  for (const Metric& metric : all_metrics()) {
    for (const TableFile& file : metric.files) names.emplace_back(file.name);
  }
  for (const std::string& label : labels) names.push_back(series_name(label));
  return names;
}

void write_csv(const StudyAnalysis& study, const std::filesystem::path& directory) {
  make_directory(directory);
  write_table(failure_table(study), directory / kFailures);
  write_cells(study, directory / kCells);
  write_consistency(study, directory / kConsistency);
  write_runs(study, directory / kRuns);
  for (const Metric& metric : all_metrics()) {
    for (const TableFile& file : metric.files) {
      if (file.applies(study)) file.write(study, directory / file.name);
    }
  }
  for (const CellAnalysis& cell : study.cells) {
    write_series(study, cell, directory / series_name(cell.label));
  }
}

}  // namespace montecarta::analysis
