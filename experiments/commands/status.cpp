// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/text_table.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/sum_groups.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/commands/summed_study.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iostream>

namespace montecarta::experiments {
namespace {

/// The state of every run of a study in each cell, collected from many files.
struct StudyStatus {
  std::string sha256;
  std::vector<std::string> labels;
  std::vector<std::vector<RunStatus>> runs;  ///< {cell}{run of the study} status of each run
};

/// Adds the statuses of all groups. It does not matter here which runs of a group failed.
void add_groups(const std::vector<SumGroup>& groups, std::vector<RunStatus>& status) {
  for (const SumGroup& group : groups) {
    const auto first = status.begin() + static_cast<std::ptrdiff_t>(group.first_run);
    std::fill_n(first, group.complete, RunStatus::complete);
    std::fill_n(first + static_cast<std::ptrdiff_t>(group.complete), group.failed,
                RunStatus::failed);
  }
}

void add(const ResultFile& file, StudyStatus& study) {
  if (study.labels.empty()) {
    study.sha256 = file.study_sha256();
    for (const StoredCell& cell : file.cells()) study.labels.push_back(cell.label);
    study.runs.assign(file.cells().size(), std::vector(file.study_runs(), RunStatus::missing));
  } else if (file.study_sha256() != study.sha256) {
    throw StudyError(file.path().string() +
                     ": holds another study (its SHA-256 differs from that of the first file): "
                     "ask for each study by itself");
  }
  for (std::size_t c = 0; c < study.labels.size(); ++c) {
    const StoredCell& cell = file.cells().at(c);
    if (file.has_sums()) {
      add_groups(file.sum_groups(cell), study.runs[c]);
      continue;
    }
    const std::vector<RunStatus> here = file.status(cell);
    for (std::size_t i = 0; i < here.size(); ++i) {
      if (here[i] != RunStatus::missing) study.runs[c].at(file.runs()[i]) = here[i];
    }
  }
}

/// Adds a result, or all files of the unfinished work on one that has sums.
void add_result(const std::string& name, StudyStatus& study) {
  const auto begun = begun_files(name);
  for (const auto& path : begun) add(ResultFile(path), study);
  if (begun.empty()) add(open_stored(name), study);
}

void print(const StudyStatus& study) {
  std::vector<TableRow> rows{{"cell", "complete", "failed", "missing", "all", "not needed"}};
  for (std::size_t c = 0; c < study.labels.size(); ++c) {
    const RunCounts counts = count_status(study.runs[c]);
    rows.push_back({study.labels[c], std::to_string(counts.complete), std::to_string(counts.failed),
                    std::to_string(counts.missing), std::to_string(study.runs[c].size()),
                    std::to_string(counts.not_needed)});
  }
  std::cout << aligned(without_idle_not_needed(std::move(rows)), 0);
}

/// How thoroughly a file is checked.
enum class Depth { statuses, every_byte };

/// A sentence such as "run 7 is damaged" about the first stored run that does not match its
/// fingerprint; empty if all match.
std::string defect_of(const ResultFile& file) {
  const ResultSlabs slabs = find_slabs(file.path(), file.description());
  const PosixFile bytes(file.path(), PosixFile::Mode::read);
  std::vector<std::byte> buffer;
  for (std::size_t c = 0; c < slabs.cells.size(); ++c) {
    const std::vector<RunStatus> status = file.status(file.cells()[c]);
    for (std::size_t i = 0; i < status.size(); ++i) {
      if (!is_stored(status[i])) continue;
      if (!truth_is_whole(bytes, slabs, i, buffer) ||
          !run_is_whole(bytes, slabs.cells[c], i, buffer))
        return formatted("run {} does not fit its fingerprint", file.runs()[i]);
    }
  }
  return {};
}

/// The fields of a line about a result, without its name. The state follows from the others.
struct StatusFields {
  std::string sha256;
  RunCounts runs;
  double seconds = 0.0;
  std::string flaw;  ///< the damage; empty if there is none
};

std::string text_of(const StatusFields& fields) {
  const char* state = !fields.flaw.empty()      ? "damaged"
                      : fields.runs.missing > 0 ? "unfinished"
                                                : "complete";
  return joined(std::vector<std::string>{state, fields.sha256, std::to_string(fields.runs.complete),
                                         std::to_string(fields.runs.failed),
                                         std::to_string(fields.runs.missing),
                                         to_text(fields.seconds), fields.flaw},
                "\t");
}

std::string line_of(const ResultFile& file, Depth depth) {
  StatusFields fields{file.study_sha256(), {}, file.wall_seconds(), {}};
  for (const StoredCell& cell : file.cells()) fields.runs += count_status(file, cell);
  if (depth == Depth::every_byte) fields.flaw = defect_of(file);
  return text_of(fields);
}

/// The line of the unfinished work on a result that has sums.
std::string line_of(const std::vector<std::filesystem::path>& begun, Depth depth) {
  StatusFields fields;
  StudyStatus study;
  for (const auto& path : begun) {
    const ResultFile file(path);
    add(file, study);
    fields.seconds += file.wall_seconds();
    if (depth == Depth::every_byte && fields.flaw.empty()) fields.flaw = defect_of(file);
  }
  fields.sha256 = study.sha256;
  for (const std::vector<RunStatus>& runs : study.runs) fields.runs += count_status(runs);
  return text_of(fields);
}

/// A line about one file for scripts, with fields separated by tabs: name, state (complete,
/// unfinished, damaged), SHA-256 of the study, numbers of complete, failed and missing runs of all
/// cells, wall time [s], error. Never throws: a file that cannot be read counts as damaged.
std::string status_line(const std::string& name, Depth depth) {
  std::string line;
  try {
    const auto begun = begun_files(name);
    line = begun.empty() ? line_of(ResultFile(name), depth) : line_of(begun, depth);
  } catch (const std::exception& error) {
    line = joined(std::vector<std::string>{"damaged", "", "0", "0", "0", "0", error.what()}, "\t");
  }
  std::ranges::replace(line, '\n', ' ');
  return formatted("{}\t{}\n", name, line);
}

}  // namespace

int status_command(const Arguments& arguments) {
  if (arguments.has("each")) {
    const Depth depth = arguments.has("whole") ? Depth::every_byte : Depth::statuses;
    for (const std::string& name : arguments.operands()) std::cout << status_line(name, depth);
    return kDone;
  }
  StudyStatus study;
  for (const std::string& name : arguments.operands()) add_result(name, study);
  print(study);
  return kDone;
}

}  // namespace montecarta::experiments
