// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/text_table.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/seal.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/stored_result.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>

namespace montecarta::experiments {
namespace {

/// How many of the runs held are neither missing nor unfinished in any cell.
std::size_t runs_done(const ResultFile& file) {
  std::vector<bool> done(file.runs().size(), true);
  for (const StoredCell& cell : file.cells()) {
    const std::vector<RunStatus> status = file.status(cell);
    for (std::size_t i = 0; i < status.size(); ++i) {
      done[i] = done[i] && status[i] != RunStatus::missing;
    }
  }
  return static_cast<std::size_t>(std::ranges::count(done, true));
}

void print_study(const ResultFile& file) {
  std::vector<TableRow> rows{
      {"study", file.study_name() + ", seed " + std::to_string(file.seed())},
      {"SHA-256", file.study_sha256()},
      {"runs", std::to_string(file.runs().size()) + " of " + std::to_string(file.study_runs()) +
                   ", of which " + std::to_string(runs_done(file)) + " are done in every cell"},
      {"a run", std::to_string(file.times().size()) + " rows of time, " +
                    std::to_string(file.scan_times().size()) + " scans"},
      {"size", bytes_text(static_cast<double>(std::filesystem::file_size(file.path())))},
      {"seal",
       check_seal(file.path()) == Seal::holds
           ? "holds"
           : "none (an older montecarta or another program wrote it: damage may go unseen)"}};
  std::cout << file.title() << "\n" << aligned(rows);
}

void print_cells(const ResultFile& file) {
  std::vector<TableRow> rows{{"cell", "filter", "complete", "failed", "missing", "spared"}};
  for (const StoredCell& cell : file.cells()) {
    const StatusCounts counts = count_status(file.status(cell));
    rows.push_back({cell.label, cell.long_name, std::to_string(counts.complete),
                    std::to_string(counts.failed), std::to_string(counts.missing),
                    std::to_string(counts.spared)});
  }
  std::cout << "\ncells\n" << aligned(without_idle_spared(std::move(rows)));
}

void print_datasets(const ResultFile& file) {
  std::vector<TableRow> rows{{"dataset", "units", "size", "meaning"}};
  const auto add = [&](const char* group, std::size_t numbers, const char* meaning) {
    const double bytes = static_cast<double>(numbers * sizeof(double));
    rows.push_back({group, "", bytes_text(bytes), meaning});
  };
  const std::size_t runs = file.runs().size();
  add("/scenario", 3 + 2 * (file.landmarks().size() + file.waypoints().size()),
      "start, landmarks and way-points");
  add("/truth", runs * (3 * file.times().size() + 1), "true poses of every run");
  add("/timing", runs * file.cells().size() + 1, "seconds that the filters took");
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

}  // namespace montecarta::experiments
