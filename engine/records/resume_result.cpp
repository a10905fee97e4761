// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/seal.hpp"

#include <algorithm>

namespace montecarta::engine {
namespace {

namespace fs = std::filesystem;

ResultDescription read_description_of(const fs::path& path) {
  try {
    return read_description(open_checked(path), path);
  } catch (const std::runtime_error& error) {
    throw StudyError(path.string() + ": cannot be resumed (" + error.what() +
                     "): start afresh with --force");
  }
}

std::string range(const ResultDescription& result) {
  return std::to_string(result.runs.front()) + ":" + std::to_string(result.runs.back() + 1);
}

void expect_same(const fs::path& path, const ResultDescription& planned,
                 const ResultDescription& stored) {
  if (const auto different = difference(planned, stored, path)) throw StudyError(*different);
  if (stored.runs == planned.runs) return;
  throw StudyError(path.string() + ": holds runs " + range(stored) + " (asked for: " +
                   range(planned) + "): give the same --runs or --shard as at the start");
}

bool begun_with_force(const ResultDescription& stored) {
  return std::ranges::any_of(stored.provenance,
                             [](const auto& pair) { return pair.first == format::kReplaces; });
}

bool holds_the_same(const fs::path& path, const ResultDescription& planned) {
  try {
    const ResultDescription stored = read_description(open_checked(path), path);
    return stored.runs == planned.runs && !difference(planned, stored, path);
  } catch (const std::runtime_error&) {
    return false;  // no result at all: the user's own file, which is not ours to replace either
  }
}

/// Finishing replaces what is at `path`; the user must have asked for that, or lose nothing by it.
void expect_replaceable(const fs::path& path, const ResultDescription& planned,
                        const ResultDescription& begun) {
  if (!is_there(path) || begun_with_force(begun) || holds_the_same(path, planned)) return;
  throw StudyError(path.string() + ": exists and is not the result that " + part_of(path).string() +
                   " becomes (finishing would replace it): move it away, then continue with "
                   "--resume, or start afresh with --force");
}

void forget(OpenResult& result, std::size_t cell, std::size_t run_index) {
  const std::byte missing{static_cast<std::uint8_t>(RunStatus::missing)};
  result.status[cell][run_index] = RunStatus::missing;
  result.file.write_at(result.slabs.cells[cell].status.at(run_index), std::span(&missing, 1));
}

/// Marks what is torn as missing; tells how many runs of cells that were.
std::size_t reset_torn_runs(OpenResult& result) {
  std::vector<std::byte> buffer;
  std::size_t torn = 0;
  for (std::size_t run = 0; run < result.truth_stored.size(); ++run) {
    result.truth_stored[run] = truth_is_whole(result.file, result.slabs, run, buffer);
    for (std::size_t cell = 0; cell < result.status.size(); ++cell) {
      if (!is_stored(result.status[cell][run])) continue;
      if (result.truth_stored[run] &&
          run_is_whole(result.file, result.slabs.cells[cell], run, buffer))
        continue;
      forget(result, cell, run);
      ++torn;
    }
  }
  return torn;
}

/// What differs from how the work was begun, "name=value" each, in one line.
std::string differences(const TextPairs& begun, const TextPairs& now) {
  std::string line;
  for (const auto& pair : now) {
    if (std::ranges::find(begun, pair) == begun.end())
      line += pair.first + "=" + pair.second + "; ";
  }
  return line.empty() ? "resumed" : line.substr(0, line.size() - 2);
}

/// Adds a line to the log of resumptions; once it is full, no more.
void log_session(const OpenResult& result, const std::string& line) {
  std::string log(format::kSittingsBytes, '\0');
  result.file.read_at(result.slabs.sittings.offset, std::as_writable_bytes(std::span(log)));
  const std::size_t length = std::min(log.find('\0'), log.size());
  if (length + line.size() + 1 > log.size()) return;
  (line + "\n").copy(log.data() + length, line.size() + 1);
  result.file.write_at(result.slabs.sittings.offset, std::as_bytes(std::span(log)));
}

OpenResult open_existing(const fs::path& path, PosixFile::Mode mode,
                         const ResultDescription& planned, ResultDescription& stored) {
  OpenResult result{PosixFile(path, mode), {}, {}, {}, {}};
  if (mode == PosixFile::Mode::write) result.file.lock();
  stored = read_description_of(path);
  expect_same(path, planned, stored);
  result.slabs = find_slabs(path, stored);
  for (const CellSlabs& cell : result.slabs.cells)
    result.status.push_back(read_statuses(result.file, cell, stored.runs.size()));
  result.truth_stored.assign(stored.runs.size(), true);
  return result;
}

/// A file has its final name only once nothing is missing, unless somebody else renamed it.
void expect_finished(const OpenResult& result) {
  std::size_t missing = 0;
  std::size_t all = 0;
  for (const auto& of_cell : result.status) {
    missing += static_cast<std::size_t>(std::ranges::count(of_cell, RunStatus::missing));
    all += of_cell.size();
  }
  if (missing == 0) return;
  const fs::path& path = result.file.path();
  throw StudyError(path.string() + ": " + std::to_string(missing) + " of " + std::to_string(all) +
                   " runs are missing (unfinished work under a final name): rename it to " +
                   part_of(path).string() + ", then continue with --resume");
}

}  // namespace

OpenResult finished_result(const fs::path& path, const ResultDescription& planned) {
  ResultDescription stored;
  OpenResult finished = open_existing(path, PosixFile::Mode::read, planned, stored);
  expect_finished(finished);
  finished.notes.push_back(path.string() + " is complete already");
  return finished;
}

OpenResult continued_work(const fs::path& work, const fs::path& path,
                          const ResultDescription& planned) {
  ResultDescription stored;
  OpenResult result = open_existing(work, PosixFile::Mode::write, planned, stored);
  expect_replaceable(path, planned, stored);
  if (is_there(path)) result.target = PosixFile::Target::replace;
  const std::size_t torn = reset_torn_runs(result);
  if (torn > 0) {
    result.notes.push_back(std::to_string(torn) +
                           " stored runs were damaged (a power cut?) and are computed again");
  }
  for (std::string& note : build_differences(stored.provenance, planned.provenance))
    result.notes.push_back(std::move(note));
  log_session(result, differences(stored.provenance, planned.provenance));
  return result;
}

OpenResult resume_result(const fs::path& path, const StudyPlan& plan, const TextPairs& provenance) {
  const bool begun = is_there(part_of(path));
  if (!begun && !is_there(path)) return create_result(path, plan, provenance, Existing::refuse);
  const ResultDescription planned = describe(plan, provenance);
  return begun ? continued_work(part_of(path), path, planned) : finished_result(path, planned);
}

}  // namespace montecarta::engine
