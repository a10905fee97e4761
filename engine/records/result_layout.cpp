// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_layout.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/h5.hpp"
#include "engine/records/result_format.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>

namespace montecarta::engine {
namespace {

class SlabFinder {
 public:
  SlabFinder(const std::filesystem::path& path, const ResultDescription& description)
      : path_(path),
        file_(h5::open_file(path)),
        runs_(description.runs.size()),
        full_runs_(description.full_runs_here()) {}

  /// Finds a dataset with `run_bytes` for each run.
  Slab find(const std::string& name, std::uint64_t run_bytes) const {
    return find(name, run_bytes, runs_);
  }
  Slab find(const std::string& name, std::uint64_t run_bytes, std::size_t runs) const {
    const h5::Handle dataset = h5::open_dataset(file_, name);
    const auto place = h5::place(dataset);
    if (place && h5::stored_bytes(dataset) != runs * run_bytes) {
      throw StudyError("{}: damaged ('{}' is not as long as its axes): run the study again", path_,
                       name);
    }
    if (!place) {
      throw StudyError(
          "{}: '{}' is not in one piece (another program rewrote the file): use the file as "
          "montecarta wrote it",
          path_, name);
    }
    return {*place, run_bytes, runs};
  }

  CellSlabs find(const StoredCell& cell) const {
    const std::string group = formatted("cells/{}/", cell.label);
    CellSlabs slabs;
    slabs.usual_columns = cell.usual_columns;
    for (std::size_t c = 0; c < cell.columns.size(); ++c) {
      slabs.columns.push_back(find(cell.dataset_of(c), cell.columns[c].bytes(),
                                   c < cell.usual_columns ? runs_ : full_runs_));
    }
    if (!cell.full().empty()) {
      slabs.full_fingerprint = find(formatted("{}{}/fingerprint", group, format::kFull),
                                    sizeof(std::uint64_t), full_runs_);
    }
    slabs.failure_reason = find(group + "failure_reason", kFailureReasonBytes);
    slabs.failure_step = find(group + "failure_step", sizeof(std::uint32_t));
    slabs.fingerprint = find(group + "fingerprint", sizeof(std::uint64_t));
    slabs.cpu_seconds = find(formatted("timing/{}/cpu_seconds", cell.label), sizeof(double));
    slabs.status = find(group + "status", 1);
    return slabs;
  }

 private:
  const std::filesystem::path& path_;
  h5::Handle file_;
  std::size_t runs_;
  std::size_t full_runs_;
};

void add_run(const PosixFile& file, const Slab& slab, std::size_t run_index,
             std::vector<std::byte>& buffer, Fingerprint& fingerprint) {
  if (buffer.size() < slab.run_bytes) buffer.resize(slab.run_bytes);
  const auto bytes = std::span(buffer).first(slab.run_bytes);
  file.read_at(slab.at(run_index), bytes);
  fingerprint.add(bytes);
}

std::uint64_t stored_fingerprint(const PosixFile& file, const Slab& slab, std::size_t run_index) {
  std::uint64_t stored = 0;
  file.read_at(slab.at(run_index), std::as_writable_bytes(std::span(&stored, 1)));
  return stored;
}

}  // namespace

ResultSlabs find_slabs(const std::filesystem::path& path, const ResultDescription& description) {
  const SlabFinder finder(path, description);
  ResultSlabs slabs;
  if (description.has_truth) {
    slabs.truth = {finder.find("truth/pose", description.times.size() * sizeof(Pose)),
                   finder.find("truth/fingerprint", sizeof(std::uint64_t)), std::nullopt};
    if (description.own_landmarks) {
      slabs.truth->landmarks =
          finder.find("truth/landmarks", description.landmarks.size() * sizeof(Eigen::Vector2d));
    }
  }
  slabs.wall_seconds = finder.find("timing/wall_seconds", sizeof(double), 1);
  slabs.sessions = finder.find("provenance/sittings", format::kSessionsBytes, 1);
  for (const StoredCell& cell : description.cells) slabs.cells.push_back(finder.find(cell));
  for (std::size_t c = 0; description.sums && c < description.cells.size(); ++c) {
    const SummedRuns& sums = *description.sums;
    const std::string& label = description.cells[c].label;
    slabs.sums.push_back(finder.find(formatted("{}/{}", format::kSums, label),
                                     sums.words[c] * sizeof(std::uint64_t), 1));
    slabs.sum_seconds.push_back(finder.find(formatted("timing/{}/{}", label, format::kSumSeconds),
                                            sizeof(double), sums.last_run - sums.first_run));
  }
  return slabs;
}

std::vector<RunStatus> read_statuses(const PosixFile& file, const CellSlabs& cell,
                                     std::size_t runs) {
  std::vector<RunStatus> statuses(runs);
  file.read_at(cell.status.offset, std::as_writable_bytes(std::span(statuses)));
  require_known(statuses, file.path().string());
  return statuses;
}

RunStatus status_of(const PosixFile& file, const CellSlabs& cell, std::size_t run_index) {
  RunStatus status{};
  file.read_at(cell.status.at(run_index), std::as_writable_bytes(std::span(&status, 1)));
  return status;
}

bool run_is_whole(const PosixFile& file, const CellSlabs& cell, std::size_t run_index,
                  std::vector<std::byte>& buffer) {
  const auto has = [&](const Slab& slab, std::uint64_t fingerprint) {
    return !slab.holds(run_index) || stored_fingerprint(file, slab, run_index) == fingerprint;
  };
  if (!is_stored(status_of(file, cell, run_index))) {
    return has(cell.fingerprint, 0) && has(cell.full_fingerprint, 0);
  }
  Fingerprint fingerprint, full;
  for (std::size_t c = 0; c < cell.columns.size(); ++c) {
    if (!cell.columns[c].holds(run_index)) continue;
    add_run(file, cell.columns[c], run_index, buffer, c < cell.usual_columns ? fingerprint : full);
  }
  for (const Slab& slab : {cell.status, cell.failure_step, cell.failure_reason})
    add_run(file, slab, run_index, buffer, fingerprint);
  return has(cell.fingerprint, fingerprint.value()) && has(cell.full_fingerprint, full.value());
}

bool truth_is_whole(const PosixFile& file, const ResultSlabs& slabs, std::size_t run_index,
                    std::vector<std::byte>& buffer) {
  if (!slabs.truth) return true;
  Fingerprint fingerprint;
  add_run(file, slabs.truth->pose, run_index, buffer, fingerprint);
  if (slabs.truth->landmarks) {
    add_run(file, *slabs.truth->landmarks, run_index, buffer, fingerprint);
  }
  return fingerprint.value() == stored_fingerprint(file, slabs.truth->fingerprint, run_index);
}

}  // namespace montecarta::engine
