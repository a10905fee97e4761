// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/merge.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/check_file.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/sum_groups.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <span>

namespace montecarta::engine {
namespace {

namespace fs = std::filesystem;

void require_mergeable(const fs::path& out, const std::vector<fs::path>& shards,
                       Existing existing) {
  std::error_code ignored;
  if (shards.empty()) throw StudyError(out.string() + ": no shards to merge: name at least one");
  for (const fs::path& shard : shards) {
    if (fs::equivalent(out, shard, ignored))
      throw StudyError(out.string() +
                       ": is one of the shards: choose another name for the merged file");
  }
  if (existing == Existing::refuse) require_free(out);
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
    found.push_back(formatted("{}:{}", runs[begin], runs[end - 1] + 1));
  }
  return found;
}

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
        require_equal(shards[source[run]], shards[s], run);
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
    for (std::uint64_t run : shards[s].complete_runs) require_whole(from, shards[s], run, buffer);
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
  require_mergeable(out, paths, existing);
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

std::optional<MergeSummary> merge_attempt(const fs::path& out,
                                          const std::vector<fs::path>& shards) {
  const fs::path own = name_of_attempt(out);
  try {
    MergeSummary summary = merge_results(own, shards, Existing::refuse);
    PosixFile file(own, PosixFile::Mode::write);
    complete_attempt(file, out);
    return summary;
  } catch (const std::runtime_error&) {
    if (!is_there(out)) throw;
    return std::nullopt;  // a faster attempt removed the file of this one
  }
}

}  // namespace montecarta::engine
