// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/open_result.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/check_file.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/result_format.hpp"
#include "engine/records/result_schema.hpp"
#include "engine/records/seal.hpp"
#include "engine/records/shard.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>
#include <system_error>
#include <unistd.h>

namespace montecarta::engine {
namespace {

namespace fs = std::filesystem;

void require_no_result(const fs::path& path) {
  require_free(path);
  if (is_there(part_of(path))) {
    throw StudyError(
        part_of(path).string() +
        ": holds unfinished work: continue it with --resume, or start afresh with --force");
  }
}

/// Throws RunError if less than `bytes` are free beside `path`.
void expect_room(const fs::path& path, double bytes) {
  std::error_code ignored;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const fs::space_info space = fs::space(folder, ignored);
  if (ignored || bytes <= static_cast<double>(space.available)) return;
  throw RunError(
      "{}: {} are needed, {} are free: free space, choose another disk, or store fewer runs or "
      "columns",
      path, bytes_text(bytes), bytes_text(static_cast<double>(space.available)));
}

/// Lays out an empty result at the temporary name `path` and returns it locked. `fill` writes the
/// part that the seal covers. Leaves no file if that fails.
PosixFile lay_out_new(const fs::path& path, const ResultDescription& description,
                      const Fill& fill = nullptr) {
  PosixFile file(path, PosixFile::Mode::create);
  file.lock();
  try {
    expect_room(path, description.bytes());
    lay_out(path, description);
    file.reserve();
    const ResultSlabs slabs = find_slabs(path, description);
    if (fill) fill(file, slabs);
    put_seal(file, written_later(slabs));
    file.sync();
  } catch (...) {
    std::error_code ignored;
    fs::remove(path, ignored);
    throw;
  }
  return file;
}

}  // namespace

std::uint64_t write_at_once(const fs::path& path, const ResultDescription& description,
                            const Fill& fill, Existing existing) {
  fs::path draft = path;
  PosixFile file = lay_out_new(draft += ".new", description, fill);
  try {
    file.rename(path, existing);
  } catch (...) {
    std::error_code ignored;
    fs::remove(draft, ignored);
    throw;
  }
  return file.size();
}

namespace {

/// Lays out the empty result `work`, in which every run is missing.
OpenResult new_work(const fs::path& work, const ResultDescription& description, Existing existing) {
  fs::path draft = work;
  OpenResult result{lay_out_new(draft += ".new", description), {}, {}, {}, {}};
  result.file.rename(work, existing);
  result.slabs = find_slabs(work, description);
  result.status.assign(description.cells.size(), std::vector<RunStatus>(description.runs.size()));
  result.truth_stored.assign(description.runs.size(), false);
  return result;
}

}  // namespace

OpenResult create_result(const fs::path& path, const StudyPlan& plan, const TextPairs& provenance,
                         Existing existing) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored))
    throw StudyError(path.string() + ": is a folder: name a file in it");
  if (existing == Existing::refuse) require_no_result(path);
  ResultDescription description = describe(plan, provenance);
  if (is_there(path)) description.provenance.emplace_back(format::kReplaces, "an older result");
  std::optional<PosixFile> replaced;  // locked, so no process is writing the replaced work
  if (is_there(part_of(path))) replaced.emplace(part_of(path), PosixFile::Mode::write).lock();
  OpenResult result =
      new_work(part_of(path), description, replaced ? Existing::replace : Existing::refuse);
  result.existing = existing;
  return result;
}

namespace {

ResultDescription read_description_of(const fs::path& path) {
  try {
    return read_description(path);
  } catch (const std::runtime_error& error) {
    throw StudyError("{}: cannot be resumed ({}): start afresh with --force", path, error.what());
  }
}

std::string range(const ResultDescription& result) {
  return formatted("{}:{}", result.runs.front(), result.runs.back() + 1);
}

void require_same(const fs::path& path, const ResultDescription& planned,
                  const ResultDescription& stored) {
  if (const auto different = difference(planned, stored, path)) throw StudyError(*different);
  if (stored.runs == planned.runs) return;
  throw StudyError(
      "{}: holds runs {} (asked for: {}): give the same --runs or --shard as at the start", path,
      range(stored), range(planned));
}

/// Says in the provenance of unfinished work that its first runs are those of the result that it
/// replaces.
constexpr const char* kFirstRuns = "a result that has the first runs";

bool is_extension(const ResultDescription& work) {
  return std::ranges::find(work.provenance,
                           std::pair<std::string, std::string>(format::kReplaces, kFirstRuns)) !=
         work.provenance.end();
}

bool begun_with_force(const ResultDescription& stored) {
  return !is_extension(stored) && std::ranges::any_of(stored.provenance, [](const auto& pair) {
    return pair.first == format::kReplaces;
  });
}

bool holds_the_same(const fs::path& path, const ResultDescription& planned) {
  try {
    const ResultDescription stored = read_description(path);
    return stored.runs == planned.runs && !difference(planned, stored, path);
  } catch (const std::runtime_error&) {
    return false;  // no result but another file of the user, which must not be replaced
  }
}

/// Whether an older result has the first runs of a plan.
enum class OlderResult : std::uint8_t { has_first_runs, is_another };

/// Throws StudyError if finishing would replace a different file at `path` without --force. An
/// extension may replace a result that has its first runs.
void require_replaceable(const fs::path& path, const ResultDescription& planned,
                         const ResultDescription& begun, OlderResult older) {
  if (!is_there(path) || begun_with_force(begun) || holds_the_same(path, planned)) return;
  if (is_extension(begun) && older == OlderResult::has_first_runs) return;
  throw StudyError(
      "{}: exists and is not the result that {} becomes (finishing would replace it): move it "
      "away, then continue with --resume, or start afresh with --force",
      path, part_of(path));
}

void forget(OpenResult& result, std::size_t cell, std::size_t run_index) {
  const std::byte missing{static_cast<std::uint8_t>(RunStatus::missing)};
  result.status[cell][run_index] = RunStatus::missing;
  result.file.write_at(result.slabs.cells[cell].status.at(run_index), std::span(&missing, 1));
}

/// Marks damaged runs as missing. Returns the number of runs of cells that were damaged.
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

/// Facts that differ from those at the beginning of the work, as "name=value" in one line.
std::string differences(const TextPairs& begun, const TextPairs& now) {
  std::string line;
  for (const auto& pair : now) {
    if (std::ranges::find(begun, pair) == begun.end())
      line += formatted("{}={}; ", pair.first, pair.second);
  }
  return line.empty() ? "resumed" : line.substr(0, line.size() - 2);
}

/// Appends a line to the log of resumptions, unless the log is full.
void log_session(const OpenResult& result, const std::string& line) {
  std::string log(format::kSessionsBytes, '\0');
  result.file.read_at(result.slabs.sessions.offset, std::as_writable_bytes(std::span(log)));
  const std::size_t length = std::min(log.find('\0'), log.size());
  if (length + line.size() + 1 > log.size()) return;
  (line + "\n").copy(log.data() + length, line.size() + 1);
  result.file.write_at(result.slabs.sessions.offset, std::as_bytes(std::span(log)));
}

OpenResult open_existing(const fs::path& path, PosixFile::Mode mode,
                         const ResultDescription& planned, ResultDescription& stored) {
  OpenResult result{PosixFile(path, mode), {}, {}, {}, {}};
  if (mode == PosixFile::Mode::write) result.file.lock();
  stored = read_description_of(path);
  require_same(path, planned, stored);
  result.slabs = find_slabs(path, stored);
  for (const CellSlabs& cell : result.slabs.cells)
    result.status.push_back(read_statuses(result.file, cell, stored.runs.size()));
  result.truth_stored.assign(stored.runs.size(), true);
  return result;
}

/// Throws StudyError if runs are missing although the file has its final name, e.g. because it was
/// renamed.
void require_finished(const OpenResult& result) {
  std::size_t missing = 0;
  std::size_t all = 0;
  for (const auto& of_cell : result.status) {
    missing += static_cast<std::size_t>(std::ranges::count(of_cell, RunStatus::missing));
    all += of_cell.size();
  }
  if (missing == 0) return;
  const fs::path& path = result.file.path();
  throw StudyError(
      "{}: {} of {} runs are missing (unfinished work under a final name): rename it to {}, then "
      "continue with --resume",
      path, missing, all, part_of(path));
}

/// Opens a result under its final name. Throws StudyError if runs are missing.
OpenResult finished_result(const fs::path& path, const ResultDescription& planned) {
  ResultDescription stored;
  OpenResult finished = open_existing(path, PosixFile::Mode::read, planned, stored);
  require_finished(finished);
  finished.notes.push_back(path.string() + " is complete already");
  return finished;
}

/// Opens unfinished work that will become `path`, and marks damaged runs as missing.
OpenResult continued_work(const fs::path& work, const fs::path& path,
                          const ResultDescription& planned, OlderResult older) {
  ResultDescription stored;
  OpenResult result = open_existing(work, PosixFile::Mode::write, planned, stored);
  require_replaceable(path, planned, stored, older);
  if (is_there(path)) result.existing = Existing::replace;
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

/// Copies undamaged runs that are missing here from another file, which has the first `runs` of the
/// runs here. Returns the number of runs of cells that were copied.
std::size_t copy_complete_runs(const PosixFile& from, const ResultSlabs& slabs, std::size_t runs,
                               OpenResult& to) {
  std::vector<std::byte> buffer;
  std::size_t copied = 0;
  for (std::size_t cell = 0; cell < to.status.size(); ++cell) {
    const auto status = read_statuses(from, slabs.cells[cell], runs);
    for (std::size_t run = 0; run < status.size(); ++run) {
      if (!is_stored(status[run]) || to.status[cell][run] != RunStatus::missing) continue;
      if (!truth_is_whole(from, slabs, run, buffer) ||
          !run_is_whole(from, slabs.cells[cell], run, buffer))
        continue;
      if (!to.truth_stored[run]) copy_truth(from, slabs, to.file, to.slabs, run);
      to.truth_stored[run] = true;
      copy_cell(from, slabs.cells[cell], to.file, to.slabs.cells[cell], run);
      to.status[cell][run] = status[run];
      ++copied;
    }
  }
  return copied;
}

/// The description of a study if it had as many runs as `stored`.
ResultDescription with_runs_of(const ResultDescription& stored, ResultDescription planned) {
  const std::string begin = "\nruns = ", runs = std::to_string(planned.study_runs);
  const std::size_t line = planned.study_text.find(formatted("{}{}\n", begin, runs));
  if (line != std::string::npos) {
    planned.study_text.replace(line + begin.size(), runs.size(), std::to_string(stored.study_runs));
  }
  planned.study_sha256 = sha256(planned.study_text);
  planned.study_runs = stored.study_runs;
  planned.full_runs = std::min(planned.full_runs, stored.study_runs);
  return planned;
}

/// The description of the result at `path` if it has the first runs of the plan and nothing else
/// differs; nullopt if there is none. Throws StudyError if such runs cannot be kept.
std::optional<ResultDescription> first_runs_at(const fs::path& path, const StudyPlan& plan,
                                               const ResultDescription& planned) {
  std::optional<ResultDescription> stored;
  try {
    if (is_there(path)) stored = read_description(path);
  } catch (const std::runtime_error&) {
    return std::nullopt;  // whoever opens the file says why
  }
  const bool is_shorter =
      stored && stored->study_runs < planned.study_runs &&
      stored->runs.size() < planned.runs.size() &&
      std::ranges::equal(stored->runs, std::span(planned.runs).first(stored->runs.size()));
  if (!is_shorter || difference(with_runs_of(*stored, planned), *stored, path)) return std::nullopt;
  if (!plan.is_enough && stored->drives.empty() && !stored->sums) return stored;
  throw StudyError(
      "{}: has {} runs, to which none can be added ({}): run the longer study into another file",
      path, stored->study_runs,
      plan.is_enough ? "study.until chose among all of them"
                     : "it holds sums, or a drive for each run");
}

/// Copies the runs of a finished result to the work that has more.
void take_over(const fs::path& path, const ResultDescription& stored, OpenResult& to) {
  const PosixFile from(path, PosixFile::Mode::read);
  const ResultSlabs slabs = find_slabs(path, stored);
  const std::size_t copied = copy_complete_runs(from, slabs, stored.runs.size(), to);
  to.notes.push_back(formatted("{} runs were taken over from {}", copied, path));
}

/// Begins the work on a result with more runs than the one at `path`, which stays until then.
OpenResult begin_extension(const fs::path& path, const ResultDescription& stored,
                           ResultDescription planned) {
  std::vector<std::string> notes = build_differences(stored.provenance, planned.provenance);
  planned.provenance.emplace_back(format::kReplaces, kFirstRuns);
  OpenResult result = new_work(part_of(path), planned, Existing::refuse);
  result.existing = Existing::replace;
  result.notes = std::move(notes);
  return result;
}

}  // namespace

OpenResult resume_result(const fs::path& path, const StudyPlan& plan, const TextPairs& provenance) {
  const bool begun = is_there(part_of(path));
  if (!begun && !is_there(path)) return create_result(path, plan, provenance, Existing::refuse);
  const ResultDescription planned = describe(plan, provenance);
  const auto first_runs = first_runs_at(path, plan, planned);
  if (!begun && !first_runs) return finished_result(path, planned);
  OpenResult result =
      begun ? continued_work(part_of(path), path, planned,
                             first_runs ? OlderResult::has_first_runs : OlderResult::is_another)
            : begin_extension(path, *first_runs, planned);
  if (first_runs && is_extension(read_description(part_of(path))))
    take_over(path, *first_runs, result);
  return result;
}

std::string name_of_process() {
  std::array<char, 65> host{};
  ::gethostname(host.data(), host.size() - 1);
  return formatted("{}.{}", host.data(), ::getpid());
}

fs::path name_of_attempt(const fs::path& path) {
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  fs::path name = part_of(path);
  return name += formatted(".{}.{}", name_of_process(), now);
}

namespace {

// A cluster may run two copies of one task: a node that lost its connection continues while the
// scheduler starts the task elsewhere, and locks do not work on network file systems. Therefore no
// process writes a file that another process may be writing, and all bytes taken from another file
// are checked.

/// The files of other attempts at `path`, finished or running: OUT.h5.part.*
std::vector<fs::path> attempts_at(const fs::path& path) {
  const std::string prefix = part_of(path).filename().string() + ".";
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::vector<fs::path> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().filename().string().starts_with(prefix)) found.push_back(entry.path());
  }
  return found;
}

/// The description in a file of an attempt; nullopt if the file is incomplete or gone. Throws
/// StudyError if it is of another study, because it would be removed when this one is complete.
std::optional<ResultDescription> description_of(const fs::path& work,
                                                const ResultDescription& planned) {
  std::optional<ResultDescription> stored;
  try {
    stored = read_description(work);
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
  if (const auto differs = difference(planned, *stored, work)) throw StudyError(*differs);
  if (stored->runs == planned.runs) return stored;
  throw StudyError(work.string() +
                   ": holds other runs of the study than are asked for (another "
                   "number of shards?): give the same --runs or --shard as at the start");
}

/// Renames OUT.h5.part, which its writer has released, to `own`. Returns false if it does not exist
/// or another attempt was faster. A network file system may report an error although it renamed the
/// file.
bool take_checkpoint(const fs::path& path, const fs::path& own, const ResultDescription& planned) {
  if (!description_of(part_of(path), planned)) return false;
  std::error_code failed;
  fs::rename(part_of(path), own, failed);
  return !failed || is_there(own);
}

/// Copies runs from another attempt, which may still be writing its file.
void copy_complete_runs(const fs::path& other, const ResultDescription& planned, OpenResult& to) {
  const auto stored = description_of(other, planned);
  if (!stored) return;
  const std::string name = other.filename().string();
  try {
    const PosixFile from(other, PosixFile::Mode::read);
    const std::size_t copied =
        copy_complete_runs(from, find_slabs(other, *stored), stored->runs.size(), to);
    if (copied > 0) to.notes.push_back(formatted("{} runs were taken over from {}", copied, name));
  } catch (const std::runtime_error& error) {
    to.notes.push_back(formatted("the rest of {} is computed again: {}", name, error.what()));
  }
}

}  // namespace

OpenResult open_attempt(const fs::path& path, const StudyPlan& plan, const TextPairs& provenance) {
  const ResultDescription planned = describe(plan, provenance);
  if (is_there(path)) return finished_result(path, planned);
  const fs::path own = name_of_attempt(path);
  OpenResult result = take_checkpoint(path, own, planned)
                          ? continued_work(own, path, planned, OlderResult::is_another)
                          : new_work(own, planned, Existing::refuse);
  result.claim = Claim::attempt;
  for (const fs::path& other : attempts_at(path)) {
    if (other != own && other.extension() != ".new") copy_complete_runs(other, planned, result);
  }
  return result;
}

void rename_finished(OpenResult& attempt, const fs::path& path) {
  std::error_code ignored;
  if (is_there(path)) {  // another attempt finished first
    fs::remove(attempt.file.path(), ignored);
    return;
  }
  if (is_there(part_of(path))) return;
  try {
    attempt.file.rename(part_of(path), Existing::refuse);
  } catch (const std::runtime_error&) {  // the next attempt finds it under its own name
  }
}

void complete_attempt(PosixFile& attempt, const fs::path& path) {
  try {
    if (!is_there(path)) attempt.rename(path, Existing::refuse);
  } catch (const std::runtime_error&) {
    if (!is_there(path)) throw;  // another attempt finished first, with the same bytes
  }
  std::error_code ignored;
  for (const fs::path& left : attempts_at(path)) fs::remove(left, ignored);
  fs::remove(part_of(path), ignored);
}

}  // namespace montecarta::engine
