// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/stale_results.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/check_file.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/benchmark/archive_entry.hpp"
#include "experiments/benchmark/benchmark_study.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/commands/summed_study.hpp"
#include "experiments/external/external_filter.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// A stored file of the program that is another one now; "" if there is none. A file that has
/// appeared since, such as a log that the program writes, does not count. Throws StudyError if a
/// stored one is gone.
std::string changed_file(const TextPairs& before, const TextPairs& now, const BenchmarkTask& task) {
  std::string changed;
  for (const auto& [name, sha] : before) {
    const auto found = std::ranges::find(now, name, &TextPairs::value_type::first);
    if (found == now.end()) {
      throw StudyError(
          "{}: no such file (it was a part of the program of {}, and paths are relative to the "
          "current folder): call montecarta in the folder where it was called before, or give the "
          "filter another label",
          name, task.name());
    }
    if (changed.empty() && found->second != sha) changed = name;
  }
  return changed;
}

/// Throws the StudyError of `holder`, which has a result or work of another study than the task.
[[noreturn]] void refuse_other_study(const BenchmarkWorker& worker, const BenchmarkTask& task,
                                     const fs::path& holder, const std::string& study_sha256,
                                     std::uint64_t runs) {
  const Study with_its_runs = benchmark_study(task.world, task.filter.cell, runs);
  const fs::path all = fs::path(task.entry).replace_extension(".*");
  if (sha256(resolved_text(with_its_runs)) == study_sha256) {
    throw StudyError(
        "{}: is of {} runs, and {} are asked for (runs cannot be added to stored sums): give "
        "--runs {}, choose another folder, or remove {}",
        holder, runs, worker.study(task).settings.count("study", "runs"), runs, all);
  }
  throw StudyError(
      "{}: is of another filter, which had this label: choose another label or folder, or remove "
      "{}",
      holder, all);
}

/// The entry of a task; nullopt if there is none. Throws StudyError if it is of another study.
std::optional<ArchiveEntry> stored_entry(const BenchmarkWorker& worker, const BenchmarkTask& task) {
  if (!is_there(task.entry)) return std::nullopt;
  std::optional<ArchiveEntry> entry;
  try {
    entry = read_entry(task.entry);
  } catch (const StudyError&) {
    if (is_there(task.entry)) throw;
    return std::nullopt;  // another worker has removed it meanwhile
  }
  if (entry->study_sha256 != sha256(resolved_text(worker.study(task))))
    refuse_other_study(worker, task, task.entry, entry->study_sha256, entry->runs);
  return entry;
}

/// The file of its program that has changed since a result was computed; "" if there is none.
std::string changed_since(const ArchiveEntry& entry, const BenchmarkWorker& worker,
                          const BenchmarkTask& task) {
  return changed_file(entry.program_files, program_files_of(worker.study(task)), task);
}

bool has_complete_runs(const fs::path& path) {
  const ResultFile file(path);
  return std::ranges::any_of(
      file.cells(), [&](const StoredCell& cell) { return count_status(file, cell).complete > 0; });
}

/// The result of a task, which may be there without an entry, and the files of unfinished work.
std::vector<fs::path> stored_files(const BenchmarkTask& task) {
  std::vector<fs::path> files;
  if (is_there(task.result())) files.push_back(task.result());
  std::error_code none;
  for (const auto& work : fs::directory_iterator(groups_of(task.result()), none))
    files.push_back(work.path());
  return files;
}

}  // namespace

TextPairs program_files_of(const Study& study) {
  const CellSpec& cell = study.cells.front();
  if (!starts_program(*cell.filter)) return {};
  const auto command =
      std::ranges::find(cell.options, "command", [](const auto& option) { return option.first; });
  return files_of_command(command->second);
}

bool has_result(const BenchmarkWorker& worker, const BenchmarkTask& task) {
  const std::optional<ArchiveEntry> entry = stored_entry(worker, task);
  return entry && changed_since(*entry, worker, task).empty();
}

bool is_of_unknown_files(const BenchmarkTask& task) {
  const ArchiveEntry entry = read_entry(task.entry);
  return starts_program(entry.filter) && entry.program_files.empty();
}

void remove_stale_result(const BenchmarkWorker& worker, const BenchmarkTask& task) {
  const std::optional<ArchiveEntry> entry = stored_entry(worker, task);
  if (!entry) return;
  const std::string changed = changed_since(*entry, worker, task);
  if (changed.empty()) return;
  worker.work.say(
      formatted("{} has changed since the result of {} was computed: it is computed again", changed,
                task.name()));
  fs::remove(task.result());  // first, because an entry can be made of it
  fs::remove(task.entry);
}

void remove_stale_work(const BenchmarkWorker& worker, const BenchmarkTask& task) {
  const Study study = worker.study(task);
  const TextPairs files = program_files_of(study);
  for (const fs::path& file : stored_files(task)) {
    std::optional<ResultDescription> stored;
    try {
      stored = read_description(file);
    } catch (const std::runtime_error&) {
      continue;  // no result file, or an incomplete one
    }
    if (stored->study_sha256 == sha256(resolved_text(study))) {
      const std::string changed = changed_file(program_files_in(stored->provenance), files, task);
      if (changed.empty()) continue;
      worker.work.say(formatted("{} has changed since work on {} began: it is begun anew", changed,
                                task.name()));
    } else if (has_complete_runs(file)) {
      refuse_other_study(worker, task, file, stored->study_sha256, stored->study_runs);
    }
    fs::remove(file);
  }
}

}  // namespace montecarta::experiments
