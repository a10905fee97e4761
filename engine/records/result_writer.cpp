// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_writer.hpp"

#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/open_result.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <span>

namespace montecarta::engine {
namespace {

template <class T>
std::span<const std::byte> bytes_of(const T& value) {
  return std::as_bytes(std::span(&value, 1));
}

}  // namespace

struct ResultWriter::Work {
  std::filesystem::path path;  ///< final name
  OpenResult result;
  bool scans_only;
  std::vector<std::uint32_t> scan_steps;
  std::function<std::vector<Eigen::Vector2d>(std::uint64_t)> own_landmarks;
  std::uint64_t first_run;
  std::vector<std::vector<std::atomic<RunStatus>>> status;  ///< [cell][run index]
  std::vector<std::atomic<bool>> truth_stored;              ///< [run index]

  Work(std::filesystem::path name, OpenResult opened, const StudyPlan& plan)
      : path(std::move(name)),
        result(std::move(opened)),
        scans_only(plan.columns.scans_only),
        scan_steps(plan.drives->itinerary().scan_step),
        own_landmarks(plan.own_landmarks),
        first_run(plan.first_run),
        truth_stored(plan.runs_here()) {
    for (const auto& of_cell : result.status) {
      status.emplace_back(of_cell.size());
      std::copy(of_cell.begin(), of_cell.end(), status.back().begin());
    }
    std::copy(result.truth_stored.begin(), result.truth_stored.end(), truth_stored.begin());
  }

  bool finished() const { return result.file.path() == path; }
  void write_poses(std::size_t run_index, const Drive& drive, Fingerprint& fingerprint) const;
  void write_landmarks(std::size_t run_index, Fingerprint& fingerprint) const;
};

ResultWriter::ResultWriter(std::unique_ptr<Work> work) : work_(std::move(work)) {}
ResultWriter::~ResultWriter() = default;
ResultWriter::ResultWriter(ResultWriter&&) noexcept = default;

ResultWriter ResultWriter::create(const std::filesystem::path& path, const StudyPlan& plan,
                                  const TextPairs& provenance, Existing existing) {
  return ResultWriter(
      std::make_unique<Work>(path, create_result(path, plan, provenance, existing), plan));
}

ResultWriter ResultWriter::resume(const std::filesystem::path& path, const StudyPlan& plan,
                                  const TextPairs& provenance) {
  return ResultWriter(std::make_unique<Work>(path, resume_result(path, plan, provenance), plan));
}

ResultWriter ResultWriter::attempt(const std::filesystem::path& path, const StudyPlan& plan,
                                   const TextPairs& provenance) {
  return ResultWriter(std::make_unique<Work>(path, attempt_result(path, plan, provenance), plan));
}

RunStatus ResultWriter::status(std::size_t cell, std::size_t run_index) const {
  return work_->status[cell][run_index].load(std::memory_order_acquire);
}

const std::vector<std::string>& ResultWriter::notes() const { return work_->result.notes; }

void ResultWriter::Work::write_poses(std::size_t run_index, const Drive& drive,
                                     Fingerprint& fingerprint) const {
  static_assert(sizeof(Pose) == 3 * sizeof(double));
  std::array<Pose, 256> rows;  // on the stack: nothing allocates here
  const Slab& slab = result.slabs.truth->pose;
  std::uint64_t offset = slab.at(run_index);
  const std::size_t count = scans_only ? scan_steps.size() : drive.truth.size();
  expect(count * sizeof(Pose) == slab.run_bytes, "a drive of another length");
  for (std::size_t begin = 0; begin < count; begin += rows.size()) {
    const std::size_t length = std::min(rows.size(), count - begin);
    for (std::size_t i = 0; i < length; ++i)
      rows[i] = drive.truth[scans_only ? scan_steps[begin + i] : begin + i];
    const auto bytes = std::as_bytes(std::span(rows).first(length));
    result.file.write_at(offset, bytes);
    fingerprint.add(bytes);
    offset += bytes.size();
  }
}

void ResultWriter::Work::write_landmarks(std::size_t run_index, Fingerprint& fingerprint) const {
  if (!result.slabs.truth->landmarks) return;
  const Slab& slab = *result.slabs.truth->landmarks;
  const std::vector<Eigen::Vector2d> landmarks = own_landmarks(first_run + run_index);
  const auto bytes = std::as_bytes(std::span(landmarks));
  expect(bytes.size() == slab.run_bytes, "a map with another number of landmarks");
  result.file.write_at(slab.at(run_index), bytes);
  fingerprint.add(bytes);
}

void ResultWriter::write_truth(std::size_t run_index, const Drive& drive) {
  const std::optional<TruthSlabs>& slabs = work_->result.slabs.truth;
  if (!slabs || work_->truth_stored[run_index].exchange(true)) return;
  Fingerprint fingerprint;
  work_->write_poses(run_index, drive, fingerprint);
  work_->write_landmarks(run_index, fingerprint);
  work_->result.file.write_at(slabs->fingerprint.at(run_index), bytes_of(fingerprint.value()));
}

void ResultWriter::write(std::size_t cell, std::size_t run_index, const RunRecord& record) {
  expect(is_stored(record.status()), "a record neither complete nor failed was handed in");
  expect(status(cell, run_index) == RunStatus::missing, "a run was stored twice");
  const PosixFile& file = work_->result.file;
  const CellSlabs& slabs = work_->result.slabs.cells[cell];
  const bool is_full = slabs.full_fingerprint.holds(run_index);
  expect(record.layout().columns().size() >= (is_full ? slabs.columns.size() : slabs.usual_columns),
         "a run that is stored in full was recorded like any other");
  for (std::size_t c = 0; c < slabs.columns.size(); ++c) {
    if (slabs.columns[c].holds(run_index))
      file.write_at(slabs.columns[c].at(run_index), record.bytes(c));
  }
  if (is_full) {
    file.write_at(slabs.full_fingerprint.at(run_index), bytes_of(record.full_fingerprint()));
  }
  file.write_at(slabs.failure_reason.at(run_index), std::as_bytes(record.failure_text()));
  file.write_at(slabs.failure_step.at(run_index), bytes_of(record.failure_step()));
  file.write_at(slabs.fingerprint.at(run_index), bytes_of(record.fingerprint()));
  file.write_at(slabs.cpu_seconds.at(run_index), bytes_of(record.cpu_seconds()));
  // Written last, so that a reader that sees the status finds all other data in place.
  file.write_at(slabs.status.at(run_index), bytes_of(record.status()));
  work_->status[cell][run_index].store(record.status(), std::memory_order_release);
}

void ResultWriter::spare(std::size_t cell, std::size_t run_index) {
  expect(status(cell, run_index) == RunStatus::missing, "a run was spared that is there");
  const RunStatus spared = RunStatus::spared;
  work_->result.file.write_at(work_->result.slabs.cells[cell].status.at(run_index),
                              bytes_of(spared));
  work_->status[cell][run_index].store(spared, std::memory_order_release);
}

const std::filesystem::path& ResultWriter::unfinished() const { return work_->result.file.path(); }

void ResultWriter::note_wall_seconds(double seconds) {
  if (work_->finished()) return;
  const Slab& slab = work_->result.slabs.wall_seconds;
  double total = 0.0;
  work_->result.file.read_at(slab.offset, std::as_writable_bytes(std::span(&total, 1)));
  total += seconds;
  work_->result.file.write_at(slab.offset, bytes_of(total));
}

void ResultWriter::suspend() {
  if (work_->finished()) return;
  work_->result.file.sync();
  if (work_->result.claim == Claim::attempt) rename_finished(work_->result, work_->path);
}

void ResultWriter::finish() {
  for (const auto& of_cell : work_->status) {
    for (const auto& status : of_cell)
      expect(status != RunStatus::missing, "a result was finished with runs missing");
  }
  if (work_->finished()) return;
  work_->result.file.sync();
  if (work_->result.claim == Claim::attempt) return complete_attempt(work_->result, work_->path);
  work_->result.file.rename(work_->path, work_->result.target);
}

}  // namespace montecarta::engine
