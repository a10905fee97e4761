// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/shard.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"

#include <algorithm>
#include <span>

namespace montecarta::engine {
namespace {

/// The stored data of a true path.
std::vector<Slab> slabs_of_truth(const ResultSlabs& slabs) {
  if (!slabs.truth) return {};
  std::vector<Slab> all = {slabs.truth->pose, slabs.truth->fingerprint};
  if (slabs.truth->landmarks) all.push_back(*slabs.truth->landmarks);
  return all;
}

/// The stored data of one run of a cell, without its status.
void add_slabs(const CellSlabs& cell, std::vector<Slab>& all) {
  all.insert(all.end(), cell.columns.begin(), cell.columns.end());
  all.insert(all.end(), {cell.full_fingerprint, cell.failure_reason, cell.failure_step,
                         cell.fingerprint, cell.cpu_seconds});
}

/// All data of one run under /cells, /truth and /timing, with the statuses last.
std::vector<Slab> slabs_of_run(const ResultSlabs& slabs) {
  std::vector<Slab> all = slabs_of_truth(slabs);
  for (const CellSlabs& cell : slabs.cells) add_slabs(cell, all);
  for (const CellSlabs& cell : slabs.cells) all.push_back(cell.status);
  return all;
}

std::vector<Slab> fingerprints(const ResultSlabs& slabs) {
  std::vector<Slab> all;
  if (slabs.truth) all.push_back(slabs.truth->fingerprint);
  for (const CellSlabs& cell : slabs.cells) {
    all.push_back(cell.fingerprint);
    all.push_back(cell.full_fingerprint);
  }
  return all;
}

std::vector<Slab> slabs_of_cell(const CellSlabs& cell) {
  std::vector<Slab> all;
  add_slabs(cell, all);
  all.push_back(cell.status);
  return all;
}

/// Consecutive runs of a file.
struct Stretch {
  const PosixFile& file;
  const std::vector<Slab>& slabs;
  std::size_t first;  ///< index of the first run in its file
};

/// Copies slab by slab, since consecutive runs are contiguous in a slab. A run that is stored in
/// full in one file is stored in full in the other.
void copy_slabs(const Stretch& from, const Stretch& to, std::size_t runs) {
  for (std::size_t i = 0; i < from.slabs.size(); ++i) {
    const Slab& slab = from.slabs[i];
    const std::size_t held = slab.runs - std::min(slab.runs, from.first);
    to.file.copy_at(to.slabs[i].at(to.first), from.file, slab.at(from.first),
                    std::min(runs, held) * slab.run_bytes);
  }
}

template <class T>
T read_value(const PosixFile& file, std::uint64_t offset) {
  T value{};
  file.read_at(offset, std::as_writable_bytes(std::span(&value, 1)));
  return value;
}

}  // namespace

Shard make_shard(const std::filesystem::path& path, const ResultDescription& description) {
  const std::vector<std::uint64_t>& runs = description.runs;
  if (runs.back() - runs.front() != runs.size() - 1) {
    throw StudyError(path.string() +
                     ": its run numbers have gaps (another program wrote it): make it anew");
  }
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

void require_equal(const Shard& a, const Shard& b, std::uint64_t run) {
  const PosixFile file_a(a.path, PosixFile::Mode::read);
  const PosixFile file_b(b.path, PosixFile::Mode::read);
  const auto slabs_a = fingerprints(a.slabs);
  const auto slabs_b = fingerprints(b.slabs);
  for (std::size_t i = 0; i < slabs_a.size(); ++i) {
    if (!slabs_a[i].holds(a.index(run))) continue;
    if (read_value<std::uint64_t>(file_a, slabs_a[i].at(a.index(run))) ==
        read_value<std::uint64_t>(file_b, slabs_b[i].at(b.index(run))))
      continue;
    throw StudyError(
        "{}: run {} differs from that in {} (made from other sources, by another compiler or C "
        "library, or damaged; 'montecarta info' tells): leave one of them out",
        b.path, run, a.path);
  }
}

void require_whole(const PosixFile& file, const Shard& shard, std::uint64_t run,
                   std::vector<std::byte>& buffer) {
  const auto not_needed = [&](const CellSlabs& cell) {
    return status_of(file, cell, shard.index(run)) == RunStatus::not_needed;
  };
  bool whole = std::ranges::all_of(shard.slabs.cells, not_needed) ||
               truth_is_whole(file, shard.slabs, shard.index(run), buffer);
  for (const CellSlabs& cell : shard.slabs.cells)
    whole = whole && run_is_whole(file, cell, shard.index(run), buffer);
  if (whole) return;
  throw StudyError(
      "{}: run {} is damaged (its bytes do not fit its fingerprint): compute this shard anew",
      shard.path, run);
}

std::vector<ByteRange> written_later(const ResultSlabs& slabs) {
  std::vector<Slab> all = slabs_of_run(slabs);
  all.insert(all.end(), {slabs.wall_seconds, slabs.sessions});
  std::ranges::sort(all, {}, &Slab::offset);
  std::vector<ByteRange> merged;
  for (const Slab& slab : all) {
    const std::uint64_t bytes = slab.runs * slab.run_bytes;
    if (bytes == 0) continue;
    if (!merged.empty() && merged.back().offset + merged.back().length == slab.offset) {
      merged.back().length += bytes;
    } else {
      merged.push_back({slab.offset, bytes});
    }
  }
  return merged;
}

void copy_runs(const PosixFile& from, const Shard& shard, RunSpan runs, const PosixFile& to,
               const ResultSlabs& slabs, std::size_t index) {
  copy_slabs({from, slabs_of_run(shard.slabs), shard.index(runs.first)},
             {to, slabs_of_run(slabs), index}, runs.count);
}

void copy_cell(const PosixFile& from, const CellSlabs& source, const PosixFile& to,
               const CellSlabs& sink, std::size_t run_index) {
  copy_slabs({from, slabs_of_cell(source), run_index}, {to, slabs_of_cell(sink), run_index}, 1);
}

void copy_truth(const PosixFile& from, const ResultSlabs& source, const PosixFile& to,
                const ResultSlabs& sink, std::size_t run_index) {
  copy_slabs({from, slabs_of_truth(source), run_index}, {to, slabs_of_truth(sink), run_index}, 1);
}

void refuse_gaps(const std::vector<std::string>& gaps, std::uint64_t missing, std::uint64_t runs,
                 const std::filesystem::path& shard) {
  constexpr std::size_t kShown = 3;
  std::string commands;
  for (std::size_t i = 0; i < std::min(gaps.size(), kShown); ++i) {
    commands += formatted("\n  montecarta run study.ini -o missing_{}.h5 --runs {}", i, gaps[i]);
  }
  throw StudyError(
      "merge: runs {} are in none of the shards ({} of {} missing; nothing was written): compute "
      "them, then merge again:\n  montecarta info {} --text > study.ini{}{}",
      joined(gaps), missing, runs, shard, commands, gaps.size() > kShown ? "\n  ..." : "");
}

}  // namespace montecarta::engine
