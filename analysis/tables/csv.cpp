// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/printed/comparison.hpp"
#include "analysis/tables.hpp"
#include "analysis/tables/cell_series.hpp"
#include "analysis/tables/csv_file.hpp"
#include "analysis/tables/number_text.hpp"
#include "analysis/tables/reference_files.hpp"
#include "analysis/tables/verdict_table.hpp"

namespace montecarta {
namespace {

constexpr const char* kFailures = "failures.csv";
constexpr const char* kCells = "cells.csv";
constexpr const char* kConsistency = "consistency.csv";
constexpr const char* kPrinted = "printed.csv";
constexpr const char* kClaims = "claims.csv";
constexpr const char* kReferences = "references.csv";
constexpr const char* kReferenceErrors = "reference_errors.csv";
std::string series_name(const std::string& label) { return "series_" + label + ".csv"; }

/// The unit belongs to the name where there is one: position_rmse_mean [m].
std::string heading(const std::string& name, const std::string& units) {
  return units == "1" ? name : name + " [" + units + "]";
}

void append(std::vector<std::string>& headings, std::vector<std::string>& fields,
            const std::vector<NamedNumber>& numbers) {
  for (const NamedNumber& number : numbers) {
    headings.push_back(heading(number.name, number.units));
    fields.push_back(exact_text(number.value));
  }
}

void write_cells(const StudyAnalysis& study, const std::filesystem::path& path) {
  CsvFile file(path);
  bool first = true;
  for (const CellAnalysis& cell : study.cells) {
    std::vector<std::string> headings = {"cell", "filter", "verdict"};
    std::vector<std::string> fields = {cell.label, cell.filter, in_words(cell.consistency())};
    append(headings, fields, numbers_of(cell));
    if (first) file.row(headings);
    file.row(fields);
    first = false;
  }
  file.close();
}

void write_consistency(const StudyAnalysis& study, const std::filesystem::path& path) {
  CsvFile file(path);
  bool first = true;
  for (const CellAnalysis& cell : study.cells) {
    for (const NeesResult& nees : cell.nees) {
      std::vector<std::string> headings = {"cell", "error", "covariance", "verdict"};
      std::vector<std::string> fields = {cell.label, name_of(nees.block), name_of(nees.moments),
                                         in_words(nees.consistency)};
      append(headings, fields, numbers_of(cell, nees, study.level));
      if (first) file.row(headings);
      file.row(fields);
      first = false;
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
  std::vector<std::string> names = {kFailures, kCells,      kConsistency,    kPrinted,
                                    kClaims,   kReferences, kReferenceErrors};
  for (const std::string& label : labels) names.push_back(series_name(label));
  return names;
}

void write_csv(const StudyAnalysis& study, const std::filesystem::path& directory) {
  make_directory(directory);
  write_table(failure_table(study), directory / kFailures);
  write_cells(study, directory / kCells);
  write_consistency(study, directory / kConsistency);
  write_table(printed_value_table(study), directory / kPrinted);
  write_table(printed_claim_table(study), directory / kClaims);
  if (!study.references.empty()) {
    write_references(study, directory / kReferences);
    write_reference_errors(study, directory / kReferenceErrors);
  }
  for (const CellAnalysis& cell : study.cells) {
    write_series(study, cell, directory / series_name(cell.label));
  }
}

}  // namespace montecarta
