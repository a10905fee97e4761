// SPDX-License-Identifier: BSD-3-Clause
// A cluster may run two copies of one task: a node that was cut off goes on while the scheduler
// starts the task elsewhere, and on network file systems no lock keeps them apart. So nobody ever
// writes a file that another process may be writing, and every byte taken over is checked.
#include "engine/errors.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/seal.hpp"
#include "engine/records/shard.hpp"

#include <array>
#include <chrono>
#include <system_error>
#include <unistd.h>

namespace montecarta::engine {
namespace {

namespace fs = std::filesystem;

/// A name nobody else has: OUT.h5.part.HOST.PID.TIME.
fs::path own_name(const fs::path& path) {
  std::array<char, 65> host{};
  ::gethostname(host.data(), host.size() - 1);
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  fs::path name = part_of(path);
  return name += "." + std::string(host.data()) + "." + std::to_string(::getpid()) + "." +
                 std::to_string(now);
}

/// What attempts at `path` left or are writing: OUT.h5.part.*
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

/// What a file of ours says of itself; nullopt where it is in the making, cut short or gone. Throws
/// StudyError where it is of another study: completing this one would remove it.
std::optional<ResultDescription> description_of(const fs::path& work,
                                                const ResultDescription& planned) {
  std::optional<ResultDescription> stored;
  try {
    stored = read_description(open_checked(work), work);
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
  if (const auto differs = difference(planned, *stored, work)) throw StudyError(*differs);
  if (stored->runs == planned.runs) return stored;
  throw StudyError(work.string() +
                   ": holds other runs of the study than are asked for (another "
                   "number of shards?): give the same --runs or --shard as at the start");
}

/// Makes OUT.h5.part, which its writer let go of, ours by its name; false where there is none or
/// another attempt was faster. A network may report a failure of what it did.
bool take_checkpoint(const fs::path& path, const fs::path& own, const ResultDescription& planned) {
  if (!description_of(part_of(path), planned)) return false;
  std::error_code failed;
  fs::rename(part_of(path), own, failed);
  return !failed || is_there(own);
}

OpenResult new_attempt(const fs::path& path, const fs::path& own,
                       const ResultDescription& planned) {
  fs::path draft = own;
  OpenResult result{lay_out_new(draft += ".new", planned), {}, {}, {}, {}};
  result.file.rename(own, PosixFile::Target::keep);
  result.slabs = find_slabs(own, planned);
  result.status.assign(planned.cells.size(), std::vector<RunStatus>(planned.runs.size()));
  result.truth_stored.assign(planned.runs.size(), false);
  if (is_there(path)) result.target = PosixFile::Target::replace;
  return result;
}

/// Copies what is whole in another attempt's file and missing here; tells how many runs of cells
/// that were.
std::size_t copy_complete_runs(const PosixFile& from, const ResultSlabs& slabs, OpenResult& to) {
  std::vector<std::byte> buffer;
  std::size_t copied = 0;
  for (std::size_t cell = 0; cell < to.status.size(); ++cell) {
    const auto status = read_statuses(from, slabs.cells[cell], to.truth_stored.size());
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

/// Takes over what another attempt stored and may still be writing.
void copy_complete_runs(const fs::path& other, const ResultDescription& planned, OpenResult& to) {
  const auto stored = description_of(other, planned);
  if (!stored) return;
  const std::string name = other.filename().string();
  try {
    const PosixFile from(other, PosixFile::Mode::read);
    const std::size_t copied = copy_complete_runs(from, find_slabs(other, *stored), to);
    if (copied > 0)
      to.notes.push_back(std::to_string(copied) + " runs were taken over from " + name);
  } catch (const std::runtime_error& error) {
    to.notes.push_back("the rest of " + name + " is computed again: " + error.what());
  }
}

}  // namespace

OpenResult attempt_result(const fs::path& path, const StudyPlan& plan,
                          const TextPairs& provenance) {
  const ResultDescription planned = describe(plan, provenance);
  if (is_there(path)) return finished_result(path, planned);
  const fs::path own = own_name(path);
  OpenResult result = take_checkpoint(path, own, planned) ? continued_work(own, path, planned)
                                                          : new_attempt(path, own, planned);
  result.claim = Claim::attempt;
  for (const fs::path& other : attempts_at(path)) {
    if (other != own && other.extension() != ".new") copy_complete_runs(other, planned, result);
  }
  return result;
}

void rename_finished(OpenResult& attempt, const fs::path& path) {
  std::error_code ignored;
  if (is_there(path)) {  // another attempt was first
    fs::remove(attempt.file.path(), ignored);
    return;
  }
  if (is_there(part_of(path))) return;
  try {
    attempt.file.rename(part_of(path), PosixFile::Target::keep);
  } catch (const std::runtime_error&) {  // then the next one finds it by its own name
  }
}

void complete_attempt(OpenResult& attempt, const fs::path& path) {
  try {
    if (!is_there(path)) attempt.file.rename(path, PosixFile::Target::keep);
  } catch (const std::runtime_error&) {
    if (!is_there(path)) throw;  // else another attempt was first, with the same bytes
  }
  std::error_code ignored;
  for (const fs::path& left : attempts_at(path)) fs::remove(left, ignored);
  fs::remove(part_of(path), ignored);
}

}  // namespace montecarta::engine
