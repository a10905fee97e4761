// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/text_table.hpp"
#include "engine/errors.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/sum_groups.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iostream>
#include <optional>

namespace montecarta::experiments {
namespace {

/// The state of every run of a study in each cell, collected from many files.
class StudyStatus {
 public:
  explicit StudyStatus(const ResultFile& first) : sha256_(first.study_sha256()) {
    for (const StoredCell& cell : first.cells()) {
      labels_.push_back(cell.label);
      status_.emplace_back(first.study_runs(), RunStatus::missing);
    }
  }

  void add(const ResultFile& file) {
    if (file.study_sha256() != sha256_) {
      throw StudyError(file.path().string() +
                       ": holds another study (its SHA-256 differs from that of the first file): "
                       "ask for each study by itself");
    }
    for (std::size_t c = 0; c < labels_.size(); ++c) {
      if (file.has_sums()) {
        add_groups(file.sum_groups(file.cells().at(c)), status_[c]);
        continue;
      }
      const std::vector<RunStatus> here = file.status(file.cells().at(c));
      for (std::size_t i = 0; i < here.size(); ++i) {
        if (here[i] != RunStatus::missing) status_[c].at(file.runs()[i]) = here[i];
      }
    }
  }

  void print() const {
    std::vector<TableRow> rows{{"cell", "complete", "failed", "missing", "all", "spared"}};
    for (std::size_t c = 0; c < labels_.size(); ++c) {
      const RunCounts counts = count_status(status_[c]);
      rows.push_back({labels_[c], std::to_string(counts.complete), std::to_string(counts.failed),
                      std::to_string(counts.missing), std::to_string(status_[c].size()),
                      std::to_string(counts.spared)});
    }
    std::cout << aligned(without_idle_spared(std::move(rows)), 0);
  }

 private:
  /// It does not matter here which runs of a group failed.
  static void add_groups(const std::vector<SumGroup>& groups, std::vector<RunStatus>& status) {
    for (const SumGroup& group : groups) {
      const auto first = status.begin() + static_cast<std::ptrdiff_t>(group.first_run);
      std::fill_n(first, group.complete, RunStatus::complete);
      std::fill_n(first + static_cast<std::ptrdiff_t>(group.complete), group.failed,
                  RunStatus::failed);
    }
  }

  std::string sha256_;
  std::vector<std::string> labels_;
  std::vector<std::vector<RunStatus>> status_;
};

/// The depth of the check of a file.
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
        return "run " + std::to_string(file.runs()[i]) + " does not fit its fingerprint";
    }
  }
  return {};
}

std::string line_of(const ResultFile& file, Depth depth) {
  RunCounts all;
  for (const StoredCell& cell : file.cells()) {
    all += count_status(file, cell);
  }
  const std::string flaw = depth == Depth::every_byte ? defect_of(file) : "";
  const char* state = !flaw.empty() ? "damaged" : all.missing > 0 ? "unfinished" : "complete";
  return joined(std::vector<std::string>{state, file.study_sha256(), std::to_string(all.complete),
                                         std::to_string(all.failed), std::to_string(all.missing),
                                         to_text(file.wall_seconds()), flaw},
                "\t");
}

/// A line about one file for scripts, with fields separated by tabs: name, state (complete,
/// unfinished, damaged), SHA-256 of the study, numbers of complete, failed and missing runs of all
/// cells, wall time [s], error. Never throws: a file that cannot be read counts as damaged.
std::string status_line(const std::string& name, Depth depth) {
  std::string line;
  try {
    line = line_of(ResultFile(name), depth);
  } catch (const std::exception& error) {
    line = joined(std::vector<std::string>{"damaged", "", "0", "0", "0", "0", error.what()}, "\t");
  }
  std::ranges::replace(line, '\n', ' ');
  return name + "\t" + line + "\n";
}

}  // namespace

int status_command(const Arguments& arguments) {
  if (arguments.has("each")) {
    const Depth depth = arguments.has("whole") ? Depth::every_byte : Depth::statuses;
    for (const std::string& name : arguments.operands()) std::cout << status_line(name, depth);
    return kDone;
  }
  std::optional<StudyStatus> status;
  for (const std::string& name : arguments.operands()) {
    const ResultFile file = open_stored(name);
    if (!status) status.emplace(file);
    status->add(file);
  }
  status->print();
  return kDone;
}

}  // namespace montecarta::experiments
