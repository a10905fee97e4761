// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/text_table.hpp"
#include "engine/formatted.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/seal.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/commands/summed_study.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>

namespace montecarta::experiments {
namespace {

/// Number of runs of the file that are missing in no cell.
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

/// Number of runs of the study. The numbers of imported runs may start anywhere.
std::uint64_t runs_of_study(const ResultFile& file) {
  const bool is_imported = !file.cells().empty() && file.cells().front().has("error");
  return is_imported ? file.runs().size() : file.study_runs();
}

void print_study(const ResultFile& file) {
  const auto& sums = file.description().sums;
  const std::string runs =
      sums ? formatted("{} of {} in sums, the first {} also in rows",
                       sums->last_run - sums->first_run, file.study_runs(), file.runs().size())
           : formatted("{} of {}, of which {} are done in every cell", file.runs().size(),
                       runs_of_study(file), runs_done(file));
  std::cout << wrapped(file.title(), output_width()) << "\n"
            << listing(
                   {{"runs", runs},
                    {"a run", formatted("{} time steps, {} scans", file.times().size(),
                                        file.scan_times().size())},
                    {"size",
                     bytes_text(static_cast<double>(std::filesystem::file_size(file.path())))},
                    {"seal", check_seal(file.path()) == Seal::holds
                                 ? "holds"
                                 : "none: an older montecarta or another program wrote the file, "
                                   "which was checked when it was opened"},
                    {"study", formatted("{}, seed {}", file.study_name(), file.seed())},
                    {"SHA-256", file.study_sha256()}});
}

void print_cells(const ResultFile& file) {
  std::vector<TableRow> rows{{"cell", "complete", "failed", "missing", "not needed"}};
  for (const StoredCell& cell : file.cells()) {
    const RunCounts counts = count_status(file, cell);
    rows.push_back({cell.label, std::to_string(counts.complete), std::to_string(counts.failed),
                    std::to_string(counts.missing), std::to_string(counts.not_needed)});
  }
  std::cout << "\ncells\n" << aligned(without_idle_not_needed(std::move(rows)));
}

struct Dataset {
  std::string name;
  double bytes = 0.0;
  std::string meaning;
};

/// Prints the name, size and meaning of each dataset, with the meaning wrapped.
void print_datasets(const std::vector<Dataset>& datasets, std::size_t indent) {
  std::vector<TableRow> rows;
  for (const Dataset& dataset : datasets) rows.push_back({dataset.name, bytes_text(dataset.bytes)});
  const auto lines = aligned_lines(rows, {Align::left, Align::right});
  TextPairs items;
  for (std::size_t i = 0; i < lines.size(); ++i) items.emplace_back(lines[i], datasets[i].meaning);
  std::cout << listing(items, indent, output_width() / 2);
}

void print_columns(const std::string& group, std::span<const Column> columns, std::size_t runs) {
  std::vector<Dataset> datasets;
  for (const Column& column : columns) {
    const std::string units = column.units == "1" ? "" : formatted(" [{}]", column.units);
    datasets.push_back(
        {column.name, static_cast<double>(column.bytes() * runs), column.long_name + units});
  }
  std::cout << "  " << group << "\n";
  print_datasets(datasets, 4);
}

void print_datasets(const ResultFile& file) {
  const auto bytes_of = [](std::size_t numbers) {
    return static_cast<double>(numbers * sizeof(double));
  };
  const std::size_t runs = file.runs().size();
  const std::size_t points = file.landmarks().size() + file.waypoints().size();
  std::cout << "\ndatasets\n";
  print_datasets(
      {{"/scenario", bytes_of(3 + 2 * points), "start, landmarks and way-points"},
       {"/truth", bytes_of(runs * (3 * file.times().size() + 1)), "true poses of every run"},
       {"/timing", bytes_of(runs * file.cells().size() + 1), "computing time of the filters [s]"}},
      2);
  if (file.has_sums()) {
    std::uint64_t words = 0;
    for (const std::uint64_t of_cell : file.description().sums->words) words += of_cell;
    print_datasets({{"/sums", bytes_of(words), "sums over groups of runs"}}, 2);
  }
  const std::size_t full_runs = file.description().full_runs_here();
  for (const StoredCell& cell : file.cells()) {
    print_columns("/cells/" + cell.label, cell.usual(), runs);
    if (!cell.full().empty())
      print_columns(formatted("/cells/{}/full", cell.label), cell.full(), full_runs);
  }
}

void print_pairs(const char* heading, const TextPairs& pairs) {
  std::cout << "\n" << heading << "\n" << listing(pairs, 2, output_width() / 2);
}

}  // namespace

int info_command(const Arguments& arguments) {
  const std::string& name = arguments.operands().front();
  const auto begun = begun_files(name);
  if (!begun.empty()) {
    std::cerr << "montecarta: " << name << " is unfinished; reading " << begun.front().string()
              << ", the first of its " << begun.size() << " files ('status' counts all runs)\n";
  }
  const ResultFile file = begun.empty() ? open_stored(name) : ResultFile(begun.front());
  if (arguments.has("text")) {
    std::cout << file.study_text();
    return kDone;
  }
  print_study(file);
  print_cells(file);
  TextPairs filters;
  for (const StoredCell& cell : file.cells()) filters.emplace_back(cell.label, cell.long_name);
  print_pairs("filters", filters);
  print_pairs("scenario", file.scenario());
  print_pairs("provenance", file.provenance());
  print_datasets(file);
  return kDone;
}

}  // namespace montecarta::experiments
