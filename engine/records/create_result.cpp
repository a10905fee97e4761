// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/seal.hpp"

#include <optional>
#include <system_error>

namespace montecarta::engine {
namespace {

namespace fs = std::filesystem;

fs::path with_suffix(fs::path path, const char* suffix) { return path += suffix; }

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

void refuse_existing(const fs::path& path) {
  expect_free(path);
  if (is_there(part_of(path))) {
    throw StudyError(
        part_of(path).string() +
        ": holds unfinished work: continue it with --resume, or start afresh with --force");
  }
}

}  // namespace

void expect_room(const fs::path& path, double bytes) {
  std::error_code ignored;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const fs::space_info space = fs::space(folder, ignored);
  if (ignored || bytes <= static_cast<double>(space.available)) return;
  throw RunError(path.string() + ": " + bytes_text(bytes) + " are needed, " +
                 bytes_text(static_cast<double>(space.available)) +
                 " are free: free space, choose another disk, or store fewer runs or columns");
}

PosixFile lay_out_new(const fs::path& path, const ResultDescription& description) {
  PosixFile file(path, PosixFile::Mode::create);
  file.lock();
  try {
    expect_room(path, description.bytes_per_run() * static_cast<double>(description.runs.size()));
    lay_out(path, description);
    put_seal(file, written_later(find_slabs(path, description), description.runs.size()));
    file.reserve();
    file.sync();
  } catch (...) {
    std::error_code ignored;
    fs::remove(path, ignored);
    throw;
  }
  return file;
}

OpenResult create_result(const fs::path& path, const StudyPlan& plan, const TextPairs& provenance,
                         Existing existing) {
  if (is_folder(path)) throw StudyError(path.string() + ": is a folder: name a file in it");
  if (existing == Existing::refuse) refuse_existing(path);
  ResultDescription description = describe(plan, provenance);
  if (is_there(path)) description.provenance.emplace_back(format::kReplaces, "an older result");
  std::optional<PosixFile> replaced;  // its lock proves that nobody writes the work we replace
  if (is_there(part_of(path))) replaced.emplace(part_of(path), PosixFile::Mode::write).lock();
  OpenResult result{lay_out_new(with_suffix(part_of(path), ".new"), description), {}, {}, {}, {}};
  result.file.rename(part_of(path),
                     replaced ? PosixFile::Target::replace : PosixFile::Target::keep);
  result.slabs = find_slabs(result.file.path(), description);
  result.status.assign(plan.cells.size(), std::vector<RunStatus>(plan.runs_here()));
  result.truth_stored.assign(plan.runs_here(), false);
  if (existing == Existing::replace) result.target = PosixFile::Target::replace;
  return result;
}

}  // namespace montecarta::engine
