// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_writer.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <unistd.h>

namespace montecarta::engine {
namespace {

template <class T>
std::span<const std::byte> bytes_of(const T& value) {
  return std::as_bytes(std::span(&value, 1));
}

}  // namespace

ResultWriter::ResultWriter(const std::filesystem::path& path, OpenResult result,
                           const StudyPlan& plan)
    : path_(path),
      result_(std::move(result)),
      scans_only_(plan.columns.scans_only),
      scan_steps_(plan.drives->itinerary().scan_step),
      own_landmarks_(plan.own_landmarks),
      first_run_(plan.first_run),
      truth_stored_(plan.runs_here()) {
  for (const auto& of_cell : result_.status) {
    status_.emplace_back(of_cell.size());
    std::ranges::copy(of_cell, status_.back().begin());
  }
  std::ranges::copy(result_.truth_stored, truth_stored_.begin());
}

ResultWriter ResultWriter::create(const std::filesystem::path& path, const StudyPlan& plan,
                                  const TextPairs& provenance, Existing existing) {
  return {path, create_result(path, plan, provenance, existing), plan};
}

ResultWriter ResultWriter::resume(const std::filesystem::path& path, const StudyPlan& plan,
                                  const TextPairs& provenance) {
  return {path, resume_result(path, plan, provenance), plan};
}

ResultWriter ResultWriter::attempt(const std::filesystem::path& path, const StudyPlan& plan,
                                   const TextPairs& provenance) {
  return {path, open_attempt(path, plan, provenance), plan};
}

RunStatus ResultWriter::status(std::size_t cell, std::size_t run_index) const {
  return status_[cell][run_index].load(std::memory_order_acquire);
}

void ResultWriter::write_poses(std::size_t run_index, const Drive& drive,
                               Fingerprint& fingerprint) const {
  static_assert(sizeof(Pose) == 3 * sizeof(double));
  std::array<Pose, 256> rows;  // on the stack: nothing allocates here
  const Slab& slab = result_.slabs.truth->pose;
  std::uint64_t offset = slab.at(run_index);
  const std::size_t count = scans_only_ ? scan_steps_.size() : drive.truth.size();
  expect(count * sizeof(Pose) == slab.run_bytes, "a drive of another length");
  for (std::size_t begin = 0; begin < count; begin += rows.size()) {
    const std::size_t length = std::min(rows.size(), count - begin);
    for (std::size_t i = 0; i < length; ++i)
      rows[i] = drive.truth[scans_only_ ? scan_steps_[begin + i] : begin + i];
    const auto bytes = std::as_bytes(std::span(rows).first(length));
    result_.file.write_at(offset, bytes);
    fingerprint.add(bytes);
    offset += bytes.size();
  }
}

void ResultWriter::write_landmarks(std::size_t run_index, Fingerprint& fingerprint) const {
  if (!result_.slabs.truth->landmarks) return;
  const Slab& slab = *result_.slabs.truth->landmarks;
  const std::vector<Eigen::Vector2d> landmarks = own_landmarks_(first_run_ + run_index);
  const auto bytes = std::as_bytes(std::span(landmarks));
  expect(bytes.size() == slab.run_bytes, "a map with another number of landmarks");
  result_.file.write_at(slab.at(run_index), bytes);
  fingerprint.add(bytes);
}

void ResultWriter::write_truth(std::size_t run_index, const Drive& drive) {
  const std::optional<TruthSlabs>& slabs = result_.slabs.truth;
  if (!slabs || truth_stored_[run_index].exchange(true)) return;
  Fingerprint fingerprint;
  write_poses(run_index, drive, fingerprint);
  write_landmarks(run_index, fingerprint);
  result_.file.write_at(slabs->fingerprint.at(run_index), bytes_of(fingerprint.value()));
}

void ResultWriter::write(std::size_t cell, std::size_t run_index, const RunRecord& record) {
  expect(is_stored(record.status()), "a record neither complete nor failed was handed in");
  expect(status(cell, run_index) == RunStatus::missing, "a run was stored twice");
  const PosixFile& file = result_.file;
  const CellSlabs& slabs = result_.slabs.cells[cell];
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
  status_[cell][run_index].store(record.status(), std::memory_order_release);
}

void ResultWriter::spare(std::size_t cell, std::size_t run_index) {
  expect(status(cell, run_index) == RunStatus::missing, "a run that is there is not needed");
  const RunStatus not_needed = RunStatus::not_needed;
  result_.file.write_at(result_.slabs.cells[cell].status.at(run_index), bytes_of(not_needed));
  status_[cell][run_index].store(not_needed, std::memory_order_release);
}

void ResultWriter::note_wall_seconds(double seconds) {
  if (is_finished()) return;
  const Slab& slab = result_.slabs.wall_seconds;
  double total = 0.0;
  result_.file.read_at(slab.offset, std::as_writable_bytes(std::span(&total, 1)));
  total += seconds;
  result_.file.write_at(slab.offset, bytes_of(total));
}

void ResultWriter::suspend() {
  if (is_finished()) return;
  result_.file.sync();
  if (result_.claim == Claim::attempt) rename_finished(result_, path_);
}

void ResultWriter::finish() {
  for (const auto& of_cell : status_) {
    for (const auto& status : of_cell)
      expect(status != RunStatus::missing, "a result was finished with runs missing");
  }
  if (is_finished()) return;
  result_.file.sync();
  if (result_.claim == Claim::attempt) return complete_attempt(result_.file, path_);
  result_.file.rename(path_, result_.existing);
}

void ResultWriter::discard() noexcept {
  if (!is_finished()) ::unlink(result_.file.path().c_str());  // another attempt may have removed it
}

}  // namespace montecarta::engine
