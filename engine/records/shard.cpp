// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/shard.hpp"

#include "engine/errors.hpp"
#include "engine/records/h5.hpp"
#include "engine/records/read_description.hpp"

#include <algorithm>
#include <span>

namespace montecarta {
namespace {

/// Everything stored of one run under /cells and /truth, and what it cost; statuses last.
std::vector<Slab> slabs_of_run(const ResultSlabs& slabs) {
  std::vector<Slab> all;
  if (slabs.truth) all = {slabs.truth->pose, slabs.truth->fingerprint};
  for (const CellSlabs& cell : slabs.cells) {
    all.insert(all.end(), cell.columns.begin(), cell.columns.end());
    all.insert(all.end(),
               {cell.failure_reason, cell.failure_step, cell.fingerprint, cell.cpu_seconds});
  }
  for (const CellSlabs& cell : slabs.cells) all.push_back(cell.status);
  return all;
}

std::vector<Slab> fingerprints(const ResultSlabs& slabs) {
  std::vector<Slab> all;
  if (slabs.truth) all.push_back(slabs.truth->fingerprint);
  for (const CellSlabs& cell : slabs.cells) all.push_back(cell.fingerprint);
  return all;
}

template <class T>
T read_value(const PosixFile& file, std::uint64_t offset) {
  T value{};
  file.read_at(offset, std::as_writable_bytes(std::span(&value, 1)));
  return value;
}

}  // namespace

ResultDescription describe_shard(const std::filesystem::path& path) {
  const PosixFile readable(path,
                           PosixFile::Mode::read);  // says better than HDF5 why it cannot be opened
  return read_description(h5::open_file(path), path);
}

Shard make_shard(const std::filesystem::path& path, const ResultDescription& description) {
  Shard shard{
      path, find_slabs(path, description), description.runs.front(), {}, description.provenance};
  const PosixFile file(path, PosixFile::Mode::read);
  std::vector<bool> complete(description.runs.size(), true);
  for (const CellSlabs& cell : shard.slabs.cells) {
    const auto status = read_statuses(file, cell, complete.size());
    for (std::size_t i = 0; i < status.size(); ++i)
      complete[i] = complete[i] && status[i] != RunStatus::missing;
  }
  for (std::size_t i = 0; i < complete.size(); ++i) {
    if (complete[i]) shard.complete_runs.push_back(description.runs[i]);
  }
  shard.wall_seconds = read_value<double>(file, shard.slabs.wall_seconds.offset);
  return shard;
}

void expect_equal(const Shard& a, const Shard& b, std::uint64_t run) {
  const PosixFile file_a(a.path, PosixFile::Mode::read);
  const PosixFile file_b(b.path, PosixFile::Mode::read);
  const auto slabs_a = fingerprints(a.slabs);
  const auto slabs_b = fingerprints(b.slabs);
  for (std::size_t i = 0; i < slabs_a.size(); ++i) {
    if (read_value<std::uint64_t>(file_a, slabs_a[i].at(a.index(run))) ==
        read_value<std::uint64_t>(file_b, slabs_b[i].at(b.index(run))))
      continue;
    throw StudyError(b.path.string() + ": run " + std::to_string(run) + " differs from that in " +
                     a.path.string() +
                     " (another build or instruction set made it, see 'montecarta info'): leave "
                     "one of them out");
  }
}

void expect_whole(const PosixFile& file, const Shard& shard, std::uint64_t run,
                  std::vector<std::byte>& buffer) {
  bool whole = truth_is_whole(file, shard.slabs, shard.index(run), buffer);
  for (const CellSlabs& cell : shard.slabs.cells)
    whole = whole && run_is_whole(file, cell, shard.index(run), buffer);
  if (whole) return;
  throw RunError(shard.path.string() + ": run " + std::to_string(run) +
                 " is damaged (its bytes do not fit its fingerprint): compute this shard anew");
}

std::uint64_t copy_run(const PosixFile& from, const Shard& shard, std::uint64_t run,
                       const PosixFile& to, const ResultSlabs& slabs) {
  const auto sources = slabs_of_run(shard.slabs);
  const auto sinks = slabs_of_run(slabs);
  for (std::size_t i = 0; i < sources.size(); ++i)
    to.copy_at(sinks[i].at(run), from, sources[i].at(shard.index(run)), sources[i].run_bytes);
  std::uint64_t failed = 0;
  for (const CellSlabs& cell : shard.slabs.cells)
    failed += read_value<RunStatus>(from, cell.status.at(shard.index(run))) == RunStatus::failed
                  ? 1U
                  : 0U;
  return failed;
}

}  // namespace montecarta
