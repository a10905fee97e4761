// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/benchmark/benchmark_study.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>

namespace montecarta::experiments {
namespace {

constexpr const char* kFolder = "studies/benchmark";

std::string folder_of_worlds() { return formatted("{}/{}", kFolder, kBenchmarkEdition); }

std::filesystem::path shipped_world(const std::string& world) {
  if (const auto path = shipped_file(folder_of_worlds(), world + ".ini")) return *path;
  throw StudyError("{}: no world of the benchmark: {}", world,
                   nearest_spelling(world, benchmark_worlds()));
}

}  // namespace

std::vector<std::string> benchmark_worlds() { return shipped_names(folder_of_worlds(), ".ini"); }

std::vector<BenchmarkFilter> benchmark_filters() {
  const auto path = shipped_file(kFolder, "filters.ini");
  expect(path.has_value(), "the filters of the benchmark are not shipped");
  std::vector<BenchmarkFilter> filters;
  for (const IniEntry& entry : read_ini(text_file(*path), path->string()).entries)
    filters.push_back(filter_of_cell(entry.value));
  return filters;
}

BenchmarkFilter filter_of_cell(const std::string& cell) {
  const std::array<IniEntry, 1> entries = {
      IniEntry{.section = "cells", .key = "cell", .value = cell, .place = "--cell " + cell}};
  const std::vector<CellSpec> cells = read_cells(entries, "--cell", known_filters(), false);
  if (cells.size() == 1) return {cells.front().label, cell};
  throw StudyError(
      "--cell {}: describes {} filters (each has results of its own): give every option one value, "
      "and repeat --cell",
      cell, cells.size());
}

Study benchmark_study(const std::string& world, const std::string& cell,
                      std::optional<std::uint64_t> runs) {
  std::vector<std::string> overrides = {"cells.cell=" + cell};
  if (runs) overrides.push_back("study.runs=" + std::to_string(*runs));
  return read_study(shipped_world(world), known_filters(), overrides);
}

bool suits(const std::string& world, const std::string& cell) {
  try {
    benchmark_study(world, cell);
    return true;
  } catch (const StudyError&) {
    return false;
  }
}

std::string drives_sha256(std::string_view resolved_text) {
  std::string kept, section;
  for (const std::string& line : split(resolved_text, '\n')) {
    if (line.starts_with('[')) section = line;
    const bool is_study = section == "[study]";
    const bool is_kept =
        is_study ? line.starts_with("seed = ") : section != "[cells]" && section != "[record]";
    if (is_kept) kept += line + "\n";
  }
  return sha256(kept);
}

}  // namespace montecarta::experiments
