// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/commands.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/text/table.hpp"

#include <filesystem>
#include <iostream>

namespace montecarta {
namespace {

void print_study(const ResultFile& file) {
  std::vector<TableRow> rows{
      {"study", file.study_name() + ", seed " + std::to_string(file.seed())},
      {"SHA-256", file.study_sha256()},
      {"runs", std::to_string(file.runs().size()) + " of " + std::to_string(file.study_runs())},
      {"a run", std::to_string(file.times().size()) + " rows of time, " +
                    std::to_string(file.scan_times().size()) + " scans"},
      {"size", bytes_text(static_cast<double>(std::filesystem::file_size(file.path())))}};
  std::cout << file.title() << "\n" << aligned(rows);
}

void print_cells(const ResultFile& file) {
  std::vector<TableRow> rows{{"cell", "filter", "complete", "failed", "missing"}};
  for (const StoredCell& cell : file.cells()) {
    const StatusCounts counts = count_status(file.status(cell));
    rows.push_back({cell.label, cell.long_name, std::to_string(counts.complete),
                    std::to_string(counts.failed), std::to_string(counts.missing)});
  }
  std::cout << "\ncells\n" << aligned(rows);
}

void print_datasets(const ResultFile& file) {
  std::vector<TableRow> rows{{"dataset", "units", "size", "meaning"}};
  for (const StoredCell& cell : file.cells()) {
    for (const Column& column : cell.columns) {
      const double bytes = static_cast<double>(column.bytes() * file.runs().size());
      rows.push_back({"/cells/" + cell.label + "/" + column.name, column.units, bytes_text(bytes),
                      column.long_name});
    }
  }
  std::cout << "\ndatasets\n" << aligned(rows);
}

void print_pairs(const char* heading,
                 const std::vector<std::pair<std::string, std::string>>& pairs) {
  std::vector<TableRow> rows;
  for (const auto& [key, value] : pairs) rows.push_back({key, value});
  std::cout << "\n" << heading << "\n" << aligned(rows);
}

int info(const Arguments& arguments) {
  const ResultFile file = open_stored(arguments.operands().front());
  if (arguments.has("text")) {
    std::cout << file.study_text();
    return kDone;
  }
  print_study(file);
  print_cells(file);
  print_pairs("scenario", file.scenario());
  print_pairs("provenance", file.provenance());
  print_datasets(file);
  return kDone;
}

}  // namespace

Command info_command() {
  return {
      {.name = "info",
       .summary = "says what is in a file: study, cells, runs done, provenance, size by dataset",
       .operands = {{"FILE.h5"}},
       .options = {{"text", "", {}, "print the study that made it, nothing else"}},
       .details = {}},
      info};
}

}  // namespace montecarta
