// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_slabs.hpp"

#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/h5.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/run_record.hpp"

#include <span>

namespace montecarta::engine {
namespace {

class SlabFinder {
 public:
  SlabFinder(const std::filesystem::path& path, std::size_t runs)
      : path_(path), file_(h5::open_file(path)), runs_(runs) {}

  /// A dataset of `run_bytes` for each run.
  Slab find(const std::string& name, std::uint64_t run_bytes) const {
    return find(name, run_bytes, runs_);
  }
  Slab find(const std::string& name, std::uint64_t run_bytes, std::size_t runs) const {
    const h5::Handle dataset = h5::open_dataset(file_, name);
    const auto place = h5::place(dataset);
    if (place && h5::stored_bytes(dataset) != runs * run_bytes) {
      throw StudyError(path_.string() + ": damaged ('" + name +
                       "' is not as long as its axes): run the study again");
    }
    if (!place) {
      throw StudyError(path_.string() + ": '" + name +
                       "' is not in one piece (another program rewrote the file): "
                       "use the file as montecarta wrote it");
    }
    return {*place, run_bytes};
  }

  CellSlabs find(const StoredCell& cell) const {
    const std::string group = "cells/" + cell.label + "/";
    CellSlabs slabs;
    for (const Column& column : cell.columns)
      slabs.columns.push_back(find(group + column.name, column.bytes()));
    slabs.failure_reason = find(group + "failure_reason", kFailureReasonBytes);
    slabs.failure_step = find(group + "failure_step", sizeof(std::uint32_t));
    slabs.fingerprint = find(group + "fingerprint", sizeof(std::uint64_t));
    slabs.cpu_seconds = find("timing/" + cell.label + "/cpu_seconds", sizeof(double));
    slabs.status = find(group + "status", 1);
    return slabs;
  }

 private:
  const std::filesystem::path& path_;
  h5::Handle file_;
  std::size_t runs_;
};

void add_run(const PosixFile& file, const Slab& slab, std::size_t run_index,
             std::vector<std::byte>& buffer, Fingerprint& fingerprint) {
  buffer.resize(slab.run_bytes);
  file.read_at(slab.at(run_index), buffer);
  fingerprint.add(buffer);
}

std::uint64_t stored_fingerprint(const PosixFile& file, const Slab& slab, std::size_t run_index) {
  std::uint64_t stored = 0;
  file.read_at(slab.at(run_index), std::as_writable_bytes(std::span(&stored, 1)));
  return stored;
}

}  // namespace

ResultSlabs find_slabs(const std::filesystem::path& path, const ResultDescription& description) {
  const SlabFinder finder(path, description.runs.size());
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
  slabs.sittings = finder.find("provenance/sittings", format::kSittingsBytes, 1);
  for (const StoredCell& cell : description.cells) slabs.cells.push_back(finder.find(cell));
  return slabs;
}

std::vector<RunStatus> read_statuses(const PosixFile& file, const CellSlabs& cell,
                                     std::size_t runs) {
  std::vector<RunStatus> statuses(runs);
  file.read_at(cell.status.offset, std::as_writable_bytes(std::span(statuses)));
  expect_known(statuses, file.path().string());
  return statuses;
}

RunStatus status_of(const PosixFile& file, const CellSlabs& cell, std::size_t run_index) {
  RunStatus status{};
  file.read_at(cell.status.at(run_index), std::as_writable_bytes(std::span(&status, 1)));
  return status;
}

bool run_is_whole(const PosixFile& file, const CellSlabs& cell, std::size_t run_index,
                  std::vector<std::byte>& buffer) {
  if (!is_stored(status_of(file, cell, run_index))) {
    return stored_fingerprint(file, cell.fingerprint, run_index) == 0;
  }
  Fingerprint fingerprint;
  for (const Slab& column : cell.columns) add_run(file, column, run_index, buffer, fingerprint);
  for (const Slab& slab : {cell.status, cell.failure_step, cell.failure_reason})
    add_run(file, slab, run_index, buffer, fingerprint);
  return fingerprint.value() == stored_fingerprint(file, cell.fingerprint, run_index);
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
