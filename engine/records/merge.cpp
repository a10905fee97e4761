// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/merge.hpp"

#include "engine/errors.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/shard.hpp"

#include <algorithm>
#include <numeric>
#include <set>

namespace montecarta::engine {
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

/// Opens every shard and makes sure that all are of one study.
std::vector<Shard> open_shards(const std::vector<fs::path>& paths, ResultDescription& first) {
  std::vector<Shard> shards;
  for (const fs::path& path : paths) {
    ResultDescription description = describe_shard(path);
    if (shards.empty()) first = description;
    if (const auto different = difference(first, description, path)) throw StudyError(*different);
    shards.push_back(make_shard(path, description));
  }
  return shards;
}

/// {"3:5", "8:9"} for the runs 3, 4 and 8.
std::vector<std::string> ranges(const std::vector<std::uint64_t>& runs) {
  std::vector<std::string> found;
  for (std::size_t begin = 0, end = 0; begin < runs.size(); begin = end) {
    while (end < runs.size() && runs[end] == runs[begin] + (end - begin)) ++end;
    found.push_back(std::to_string(runs[begin]) + ":" + std::to_string(runs[end - 1] + 1));
  }
  return found;
}

/// Names what is missing, and the commands that fill the first gaps.
[[noreturn]] void refuse_gaps(const std::vector<std::uint64_t>& missing, std::uint64_t runs,
                              const fs::path& shard) {
  std::string named, commands;
  const std::vector<std::string> gaps = ranges(missing);
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    named += (i == 0 ? "" : ", ") + gaps[i];
    if (i < 3)
      commands +=
          "\n  montecarta run study.ini -o missing_" + std::to_string(i) + ".h5 --runs " + gaps[i];
  }
  throw StudyError("merge: runs " + named + " are in none of the shards (" +
                   std::to_string(missing.size()) + " of " + std::to_string(runs) +
                   " missing; nothing was written): compute them, then merge again:\n  montecarta "
                   "info " +
                   shard.string() + " --text > study.ini" + commands +
                   (gaps.size() > 3 ? "\n  ..." : ""));
}

/// For every run of the study which shard gives it. Runs held twice must be equal.
std::vector<std::size_t> choose_sources(const std::vector<Shard>& shards, std::uint64_t runs,
                                        MergeSummary& summary) {
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> source(runs, none);
  for (std::size_t s = 0; s < shards.size(); ++s) {
    for (std::uint64_t run : shards[s].complete_runs) {
      if (source.at(run) == none) {
        source[run] = s;
      } else {
        expect_equal(shards[source[run]], shards[s], run);
        ++summary.overlapping;
      }
    }
  }
  std::vector<std::uint64_t> missing;
  for (std::uint64_t run = 0; run < runs; ++run) {
    if (source[run] == none) missing.push_back(run);
  }
  if (!missing.empty()) refuse_gaps(missing, runs, shards.front().path);
  return source;
}

/// The description of the whole study: that of the first shard with all runs.
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

/// The runs that shard `s` gives, in stretches.
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
               const PosixFile& file, const ResultSlabs& slabs, MergeSummary& summary) {
  std::vector<std::byte> buffer;
  for (std::size_t s = 0; s < shards.size(); ++s) {
    const PosixFile from(shards[s].path, PosixFile::Mode::read);
    // Also those that another shard gives: equal by fingerprints that fit both.
    for (std::uint64_t run : shards[s].complete_runs) expect_whole(from, shards[s], run, buffer);
    for (const RunSpan& runs : given_by(shards[s], s, source))
      summary.failed += copy_runs(from, shards[s], runs, file, slabs);
  }
  double seconds = 0.0;
  for (const Shard& shard : shards) seconds += shard.wall_seconds;
  file.write_at(slabs.wall_seconds.offset, std::as_bytes(std::span(&seconds, 1)));
}

}  // namespace

MergeSummary merge_results(const fs::path& out, const std::vector<fs::path>& paths,
                           Existing existing) {
  expect_mergeable(out, paths, existing);
  ResultDescription description;
  const std::vector<Shard> shards = open_shards(paths, description);
  MergeSummary summary;
  summary.runs = description.study_runs;
  summary.cells = description.cells.size();
  const auto source = choose_sources(shards, description.study_runs, summary);
  note_builds(shards, summary);
  fs::path temporary = out;
  temporary += ".merging";
  const ResultDescription whole = whole_study(description, shards.size());
  PosixFile file = lay_out_new(temporary, whole);
  try {
    copy_runs(shards, source, file, find_slabs(temporary, whole), summary);
    file.sync();
    summary.bytes = file.size();
    file.rename(
        out, existing == Existing::replace ? PosixFile::Target::replace : PosixFile::Target::keep);
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
  return summary;
}

}  // namespace montecarta::engine
