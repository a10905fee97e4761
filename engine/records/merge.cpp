// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/merge.hpp"

#include "engine/errors.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/seal.hpp"
#include "engine/records/sum_groups.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <span>
#include <sstream>

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
  std::size_t first;  ///< run index
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

void expect_equal(const Shard& a, const Shard& b, std::uint64_t run) {
  const PosixFile file_a(a.path, PosixFile::Mode::read);
  const PosixFile file_b(b.path, PosixFile::Mode::read);
  const auto slabs_a = fingerprints(a.slabs);
  const auto slabs_b = fingerprints(b.slabs);
  for (std::size_t i = 0; i < slabs_a.size(); ++i) {
    if (!slabs_a[i].holds(a.index(run))) continue;
    if (read_value<std::uint64_t>(file_a, slabs_a[i].at(a.index(run))) ==
        read_value<std::uint64_t>(file_b, slabs_b[i].at(b.index(run))))
      continue;
    throw StudyError(b.path.string() + ": run " + std::to_string(run) + " differs from that in " +
                     a.path.string() +
                     " (made from other sources, by another compiler or C library, or damaged; "
                     "'montecarta info' tells): leave one of them out");
  }
}

void expect_whole(const PosixFile& file, const Shard& shard, std::uint64_t run,
                  std::vector<std::byte>& buffer) {
  const auto spared = [&](const CellSlabs& cell) {
    return status_of(file, cell, shard.index(run)) == RunStatus::spared;
  };
  bool whole = std::ranges::all_of(shard.slabs.cells, spared) ||
               truth_is_whole(file, shard.slabs, shard.index(run), buffer);
  for (const CellSlabs& cell : shard.slabs.cells)
    whole = whole && run_is_whole(file, cell, shard.index(run), buffer);
  if (whole) return;
  throw StudyError(shard.path.string() + ": run " + std::to_string(run) +
                   " is damaged (its bytes do not fit its fingerprint): compute this shard anew");
}

std::vector<ByteRange> written_later(const ResultSlabs& slabs) {
  std::vector<Slab> all = slabs_of_run(slabs);
  all.insert(all.end(), {slabs.wall_seconds, slabs.sittings});
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

namespace {

bool same_column(const Column& a, const Column& b) {
  return a.name == b.name && a.element == b.element && a.shape == b.shape;
}

bool same_columns(const StoredCell& a, const StoredCell& b) {
  return a.label == b.label && a.usual_columns == b.usual_columns &&
         std::ranges::equal(a.columns, b.columns, same_column);
}

/// A fact about a build. Flags are returned without the instruction set, which does not change any
/// bit.
std::optional<std::string> fact(const TextPairs& build, const std::string& name) {
  const auto found = std::ranges::find(build, name, [](const auto& pair) { return pair.first; });
  if (found == build.end()) return std::nullopt;
  if (name != "flags") return found->second;
  std::istringstream words(found->second);
  std::string rest;
  for (std::string word; words >> word;) {
    if (!word.starts_with("-march=")) rest += (rest.empty() ? "" : " ") + word;
  }
  return rest;
}

}  // namespace

std::optional<std::string> difference(const ResultDescription& a, const ResultDescription& b,
                                      const std::filesystem::path& path) {
  if (a.study_sha256 != b.study_sha256) {
    return path.string() + ": belongs to another study ('" + b.study_name + "', SHA-256 " +
           b.study_sha256.substr(0, 12) + ", not '" + a.study_name + "', " +
           a.study_sha256.substr(0, 12) +
           "): give the files of one study, made with the same --set";
  }
  if (std::ranges::equal(a.cells, b.cells, same_columns) && a.full_runs == b.full_runs &&
      a.times == b.times && a.scan_steps == b.scan_steps && a.joint_scans == b.joint_scans)
    return std::nullopt;
  return path.string() +
         ": is laid out differently (another version of montecarta, or of a world file, made it): "
         "make it anew";
}

std::vector<std::string> build_differences(const TextPairs& a, const TextPairs& b) {
  std::vector<std::string> found;
  for (const char* name : {"version", "git", "compiler", "flags", "libm"}) {
    const std::optional<std::string> in_a = fact(a, name), in_b = fact(b, name);
    if (!in_a || !in_b || *in_a == *in_b) continue;
    found.push_back("two builds worked on this study (" + std::string(name) + ": " + *in_a +
                    " and " + *in_b + "): the last digits of their runs may differ");
  }
  return found;
}

namespace {

namespace fs = std::filesystem;

void expect_mergeable(const fs::path& out, const std::vector<fs::path>& shards, Existing existing) {
  std::error_code ignored;
  if (shards.empty()) throw StudyError(out.string() + ": no shards to merge: name at least one");
  for (const fs::path& shard : shards) {
    if (fs::equivalent(out, shard, ignored))
      throw StudyError(out.string() +
                       ": is one of the shards: choose another name for the merged file");
  }
  if (existing == Existing::refuse) expect_free(out);
}

/// Opens every shard, and throws StudyError unless all are of one study.
std::vector<Shard> open_shards(const std::vector<fs::path>& paths, ResultDescription& first) {
  std::vector<Shard> shards;
  for (const fs::path& path : paths) {
    ResultDescription description = read_description(path);
    if (shards.empty()) first = description;
    if (const auto different = difference(first, description, path)) throw StudyError(*different);
    shards.push_back(make_shard(path, description));
  }
  return shards;
}

/// Ranges of consecutive runs: {"3:5", "8:9"} for the runs 3, 4 and 8.
std::vector<std::string> ranges(const std::vector<std::uint64_t>& runs) {
  std::vector<std::string> found;
  for (std::size_t begin = 0, end = 0; begin < runs.size(); begin = end) {
    while (end < runs.size() && runs[end] == runs[begin] + (end - begin)) ++end;
    found.push_back(std::to_string(runs[begin]) + ":" + std::to_string(runs[end - 1] + 1));
  }
  return found;
}

}  // namespace

void refuse_gaps(const std::vector<std::string>& gaps, std::uint64_t missing, std::uint64_t runs,
                 const fs::path& shard) {
  std::string named, commands;
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    named += (i == 0 ? "" : ", ") + gaps[i];
    if (i < 3)
      commands +=
          "\n  montecarta run study.ini -o missing_" + std::to_string(i) + ".h5 --runs " + gaps[i];
  }
  throw StudyError("merge: runs " + named + " are in none of the shards (" +
                   std::to_string(missing) + " of " + std::to_string(runs) +
                   " missing; nothing was written): compute them, then merge again:\n  montecarta "
                   "info " +
                   shard.string() + " --text > study.ini" + commands +
                   (gaps.size() > 3 ? "\n  ..." : ""));
}

namespace {

/// Chooses the shard from which each run of the study is copied. Throws StudyError if a run differs
/// between two shards.
std::vector<std::size_t> choose_sources(const std::vector<Shard>& shards, std::uint64_t runs) {
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> source(runs, none);
  for (std::size_t s = 0; s < shards.size(); ++s) {
    for (std::uint64_t run : shards[s].complete_runs) {
      if (source.at(run) == none) {
        source[run] = s;
      } else {
        expect_equal(shards[source[run]], shards[s], run);
      }
    }
  }
  std::vector<std::uint64_t> missing;
  for (std::uint64_t run = 0; run < runs; ++run) {
    if (source[run] == none) missing.push_back(run);
  }
  if (!missing.empty()) refuse_gaps(ranges(missing), missing.size(), runs, shards.front().path);
  return source;
}

/// The description of the whole study, derived from that of the first shard.
ResultDescription whole_study(ResultDescription description, std::size_t n_shards) {
  description.runs.resize(description.study_runs);
  std::iota(description.runs.begin(), description.runs.end(), 0U);
  description.provenance.emplace_back(
      "merged_from", std::to_string(n_shards) + " shards; the facts here are the first one's");
  return description;
}

void note_builds(const std::vector<Shard>& shards, MergeSummary& summary) {
  std::set<std::string> seen;
  for (const Shard& shard : shards) {
    for (const std::string& note : build_differences(shards.front().provenance, shard.provenance)) {
      if (seen.insert(note).second) summary.notes.push_back(note);
    }
  }
}

/// The runs that are copied from shard `s`, as ranges of consecutive runs.
std::vector<RunSpan> given_by(const Shard& shard, std::size_t s,
                              const std::vector<std::size_t>& source) {
  std::vector<RunSpan> spans;
  for (std::uint64_t run : shard.complete_runs) {
    if (source[run] != s) continue;
    if (spans.empty() || spans.back().first + spans.back().count != run) spans.push_back({run, 0});
    ++spans.back().count;
  }
  return spans;
}

void copy_runs(const std::vector<Shard>& shards, const std::vector<std::size_t>& source,
               const PosixFile& file, const ResultSlabs& slabs) {
  std::vector<std::byte> buffer;
  for (std::size_t s = 0; s < shards.size(); ++s) {
    const PosixFile from(shards[s].path, PosixFile::Mode::read);
    // Runs that are copied from another shard are checked too: they were compared by fingerprints,
    // which must match the bytes in both shards.
    for (std::uint64_t run : shards[s].complete_runs) expect_whole(from, shards[s], run, buffer);
    for (const RunSpan& runs : given_by(shards[s], s, source))
      copy_runs(from, shards[s], runs, file, slabs, runs.first);
  }
  double seconds = 0.0;
  for (const Shard& shard : shards) seconds += shard.wall_seconds;
  file.write_at(slabs.wall_seconds.offset, std::as_bytes(std::span(&seconds, 1)));
}

}  // namespace

MergeSummary merge_results(const fs::path& out, const std::vector<fs::path>& paths,
                           Existing existing) {
  expect_mergeable(out, paths, existing);
  ResultDescription description = read_description(paths.front());
  if (description.sums) return merge_groups(out, paths, 0, description.study_runs, existing);
  const std::vector<Shard> shards = open_shards(paths, description);
  MergeSummary summary;
  summary.runs = description.study_runs;
  summary.cells = description.cells.size();
  const auto source = choose_sources(shards, description.study_runs);
  note_builds(shards, summary);
  const auto fill = [&](const PosixFile& file, const ResultSlabs& slabs) {
    copy_runs(shards, source, file, slabs);
  };
  summary.bytes = write_at_once(out, whole_study(description, shards.size()), fill, existing);
  return summary;
}

}  // namespace montecarta::engine
