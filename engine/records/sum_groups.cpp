// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/sum_groups.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/check_file.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/result_format.hpp"
#include "engine/records/seal.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

namespace montecarta::engine {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kWordBytes = sizeof(std::uint64_t);

[[noreturn]] void refuse_sums(const fs::path& path) {
  throw StudyError(path.string() +
                   ": damaged (its sums are not those of its groups of runs): take a copy that is "
                   "whole, or run the study again");
}

std::vector<std::uint64_t> read_words(const PosixFile& file, std::uint64_t offset,
                                      std::uint64_t count) {
  std::vector<std::uint64_t> words(count);
  file.read_at(offset, std::as_writable_bytes(std::span(words)));
  return words;
}

SumGroup read_head(const PosixFile& file, std::uint64_t offset) {
  const auto words = read_words(file, offset, kGroupHeadWords);
  return {words[0], words[1], words[2], words[3], words[4], words[5], offset};
}

std::array<std::uint64_t, kGroupHeadWords> head_words(const SumGroup& group) {
  return {group.first_run, group.runs, group.complete, group.failed, group.layout, group.words};
}

/// The first run after the group that begins at `run`.
std::uint64_t end_of_group(std::uint64_t run, const SummedRuns& runs) {
  return std::min(run + kRunsOfAGroup, runs.last_run);
}

}  // namespace

std::vector<SumGroup> find_groups(const PosixFile& file, const Slab& sums, const SummedRuns& runs) {
  std::vector<SumGroup> groups;
  std::uint64_t left = sums.run_bytes / kWordBytes, offset = sums.offset;
  for (std::uint64_t run = runs.first_run; run < runs.last_run; run = end_of_group(run, runs)) {
    if (left < kGroupHeadWords) refuse_sums(file.path());
    const SumGroup group = read_head(file, offset);
    left -= kGroupHeadWords;
    const std::uint64_t count = end_of_group(run, runs) - run;
    const bool is_next = group.first_run == run && group.runs == count && group.complete <= count &&
                         group.failed == count - group.complete;
    if (!is_next || group.words > left) refuse_sums(file.path());
    left -= group.words;
    offset += (kGroupHeadWords + group.words) * kWordBytes;
    groups.push_back(group);
  }
  if (left != 0) refuse_sums(file.path());
  return groups;
}

std::vector<std::uint64_t> read_sums(const PosixFile& file, const SumGroup& group) {
  return read_words(file, group.offset + kGroupHeadWords * kWordBytes, group.words);
}

namespace {

/// Copies the runs that a result with sums has from a file that has them, and perhaps more.
void copy_first_runs(const Shard& from, const ResultDescription& description, const PosixFile& to,
                     const ResultSlabs& slabs) {
  const PosixFile file(from.path, PosixFile::Mode::read);
  std::vector<std::byte> buffer;
  for (const std::uint64_t run : description.runs) require_whole(file, from, run, buffer);
  copy_runs(file, from, {description.runs.front(), description.runs.size()}, to, slabs, 0);
}

/// The description of a result with sums, from one that has its first runs and perhaps more.
ResultDescription with_sums(ResultDescription description, SummedRuns sums) {
  const std::uint64_t kept = std::max(kRunsBesideSums, description.full_runs);
  description.runs.resize(std::min<std::uint64_t>(kept, sums.last_run - sums.first_run));
  std::iota(description.runs.begin(), description.runs.end(), sums.first_run);
  description.sums = std::move(sums);
  return description;
}

void write_seconds(const PosixFile& file, const ResultSlabs& slabs, double seconds) {
  file.write_at(slabs.wall_seconds.offset, std::as_bytes(std::span(&seconds, 1)));
}

}  // namespace

void write_group(const fs::path& out, const fs::path& rows, std::span<const NewGroup> cells) {
  const ResultDescription all = read_description(rows);
  const Shard shard = make_shard(rows, all);
  SummedRuns sums{all.runs.front(), all.runs.back() + 1, {}};
  for (const NewGroup& cell : cells) sums.words.push_back(kGroupHeadWords + cell.sums.size());
  const ResultDescription description = with_sums(all, std::move(sums));
  const fs::path own = name_of_attempt(out);
  write_at_once(
      own, description,
      [&](const PosixFile& file, const ResultSlabs& slabs) {
        copy_first_runs(shard, description, file, slabs);
        for (std::size_t c = 0; c < cells.size(); ++c) {
          const auto head = head_words(cells[c].head);
          file.write_at(slabs.sums[c].offset, std::as_bytes(std::span(head)));
          file.write_at(slabs.sums[c].offset + kGroupHeadWords * kWordBytes,
                        std::as_bytes(std::span(cells[c].sums)));
          file.write_at(slabs.sum_seconds[c].offset,
                        std::as_bytes(std::span(cells[c].cpu_seconds)));
        }
        write_seconds(file, slabs, shard.wall_seconds);
      },
      Existing::replace);
  PosixFile(own, PosixFile::Mode::write).rename(out, Existing::replace);
}

namespace {

/// A result with sums from which others are made.
struct SumShard : Shard {
  ResultDescription description;
  std::vector<std::vector<SumGroup>> groups;  ///< {cell} groups of each cell
};

SumShard open_sum_shard(const fs::path& path) {
  ResultDescription description = read_description(path);
  if (!description.sums)
    throw StudyError(path.string() + ": has no sums: give shards of one study");
  if (check_seal(path) != Seal::holds) refuse_sums(path);
  SumShard shard{make_shard(path, description), std::move(description), {}};
  const PosixFile file(path, PosixFile::Mode::read);
  for (const Slab& sums : shard.slabs.sums)
    shard.groups.push_back(find_groups(file, sums, *shard.description.sums));
  return shard;
}

std::vector<SumShard> open_sum_shards(const std::vector<fs::path>& paths) {
  std::vector<SumShard> shards;
  for (const fs::path& path : paths) {
    shards.push_back(open_sum_shard(path));
    const auto different = difference(shards.front().description, shards.back().description, path);
    if (different) throw StudyError(*different);
  }
  return shards;
}

/// Throws StudyError unless the group `g` of `a` and `h` of `b`, which are of the same runs, are
/// equal in all cells.
void require_equal_groups(const SumShard& a, std::size_t g, const SumShard& b, std::size_t h) {
  const PosixFile file_a(a.path, PosixFile::Mode::read), file_b(b.path, PosixFile::Mode::read);
  for (std::size_t c = 0; c < a.groups.size(); ++c) {
    const SumGroup &left = a.groups[c][g], &right = b.groups[c][h];
    if (left.words == right.words && head_words(left) == head_words(right) &&
        read_sums(file_a, left) == read_sums(file_b, right))
      continue;
    throw StudyError(
        "{}: the sums from run {} on differ from those in {} (made from other sources, by another "
        "compiler or C library; 'montecarta info' tells): leave one of them out",
        b.path, right.first_run, a.path);
  }
}

/// The place of the sums over a group.
struct Source {
  const SumShard* shard = nullptr;
  std::size_t group = 0;
};

/// Returns {group from first_run on} the source of each group. A group is missing if its source has
/// no shard.
std::vector<Source> sources_of(const std::vector<SumShard>& shards, std::uint64_t first_run,
                               std::uint64_t last_run) {
  std::vector<Source> sources((last_run - first_run + kRunsOfAGroup - 1) / kRunsOfAGroup);
  for (const SumShard& shard : shards) {
    for (std::size_t g = 0; g < shard.groups.front().size(); ++g) {
      const SumGroup& group = shard.groups.front()[g];
      if (group.first_run < first_run || group.first_run >= last_run) continue;
      Source& source = sources[(group.first_run - first_run) / kRunsOfAGroup];
      if (source.shard != nullptr) {
        require_equal_groups(*source.shard, source.group, shard, g);
      } else {
        source = {&shard, g};
      }
    }
  }
  return sources;
}

void require_all_groups(const std::vector<Source>& sources, std::uint64_t first_run,
                        std::uint64_t last_run, const fs::path& shard) {
  std::vector<std::string> gaps;
  std::uint64_t missing = 0;
  for (std::size_t k = 0; k < sources.size(); ++k) {
    if (sources[k].shard != nullptr) continue;
    const std::uint64_t begin = first_run + k * kRunsOfAGroup;
    const std::uint64_t end = std::min(begin + kRunsOfAGroup, last_run);
    gaps.push_back(formatted("{}:{}", begin, end));
    missing += end - begin;
  }
  if (missing > 0) refuse_gaps(gaps, missing, last_run - first_run, shard);
}

/// All groups of a new file, one behind the other.
SummedRuns summed_runs(const std::vector<Source>& sources, std::uint64_t first_run,
                       std::uint64_t last_run) {
  SummedRuns sums{first_run, last_run, {}};
  sums.words.resize(sources.front().shard->groups.size());
  for (const auto& [shard, g] : sources) {
    for (std::size_t c = 0; c < sums.words.size(); ++c)
      sums.words[c] += kGroupHeadWords + shard->groups[c][g].words;
  }
  return sums;
}

/// Copies the sums of all groups, one behind the other, and the processor times of their runs.
void copy_groups(const std::vector<Source>& sources, std::uint64_t first_run, const PosixFile& file,
                 const ResultSlabs& slabs) {
  std::vector<std::uint64_t> offsets;
  for (const Slab& sums : slabs.sums) offsets.push_back(sums.offset);
  for (const auto& [shard, g] : sources) {
    const PosixFile from(shard->path, PosixFile::Mode::read);
    for (std::size_t c = 0; c < offsets.size(); ++c) {
      const SumGroup& group = shard->groups[c][g];
      const std::uint64_t bytes = (kGroupHeadWords + group.words) * kWordBytes;
      file.copy_at(offsets[c], from, group.offset, bytes);
      file.copy_at(slabs.sum_seconds[c].at(group.first_run - first_run), from,
                   shard->slabs.sum_seconds[c].at(shard->index(group.first_run)),
                   group.runs * sizeof(double));
      offsets[c] += bytes;
    }
  }
}

}  // namespace

MergeSummary merge_groups(const fs::path& out, const std::vector<fs::path>& paths,
                          std::uint64_t first_run, std::uint64_t last_run, Existing existing) {
  const std::vector<SumShard> shards = open_sum_shards(paths);
  MergeSummary summary{.runs = last_run - first_run, .notes = {}};
  const std::vector<Source> sources = sources_of(shards, first_run, last_run);
  require_all_groups(sources, first_run, last_run, paths.front());
  const SumShard& first = *sources.front().shard;
  summary.cells = first.description.cells.size();
  const ResultDescription description =
      with_sums(first.description, summed_runs(sources, first_run, last_run));
  double seconds = 0.0;
  for (const SumShard& shard : shards) seconds += shard.wall_seconds;
  const auto fill = [&](const PosixFile& file, const ResultSlabs& slabs) {
    copy_first_runs(first, description, file, slabs);
    copy_groups(sources, first_run, file, slabs);
    write_seconds(file, slabs, seconds);
  };
  summary.bytes = write_at_once(out, description, fill, existing);
  return summary;
}

}  // namespace montecarta::engine
