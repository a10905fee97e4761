// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/plan.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/run_record.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace montecarta::engine {

/// Writes the result file of a plan. Unfinished work is in OUT.h5.part, which any HDF5 reader can
/// open at any time; finish() renames it. A thread writes its run directly to its place in the
/// file, the status byte last, so that there is no queue and `kill -9` loses only the current runs.
/// `run_index` counts from 0 within this file: it stands for run number plan.first_run + run_index.
/// Throws StudyError if the user must act first (existing result, other study, path), and RunError
/// if the disk fails.
class ResultWriter {
 public:
  /// Lays out a new file. `existing` also applies to an unfinished OUT.h5.part. An OUT.h5 that is
  /// to be replaced stays unchanged until finish(). `provenance` is stored as attributes of
  /// /provenance.
  static ResultWriter create(const std::filesystem::path& path, const StudyPlan& plan,
                             const TextPairs& provenance, Existing existing);
  /// Continues OUT.h5.part, opens OUT.h5 if it is complete, or begins if neither exists. Throws
  /// StudyError if OUT.h5 is of another study or other runs, unless the work was begun with
  /// `replace`. Stored runs that do not match their fingerprints (after a power cut) become missing
  /// again.
  static ResultWriter resume(const std::filesystem::path& path, const StudyPlan& plan,
                             const TextPairs& provenance);
  /// Makes one of several attempts at the same result, perhaps by machines that were considered
  /// dead. Works in a file of its own, OUT.h5.part.*, and copies undamaged runs from other
  /// attempts, finished or running, without disturbing them. The first attempt that is complete
  /// becomes OUT.h5. Opens OUT.h5 if it is complete, like resume().
  static ResultWriter attempt(const std::filesystem::path& path, const StudyPlan& plan,
                              const TextPairs& provenance);

  /// Status of this run of this cell in the file. Thread-safe.
  RunStatus status(std::size_t cell, std::size_t run_index) const;
  /// Messages for the user about a resumption ("3 runs were damaged ..."), one sentence each.
  const std::vector<std::string>& notes() const { return result_.notes; }

  /// Stores the true path of a run. Must be called once for every drive, before write().
  /// Thread-safe.
  void write_truth(std::size_t run_index, const Drive& drive);
  /// Stores a finished run (complete or failed), once. Thread-safe for different (cell, run).
  void write(std::size_t cell, std::size_t run_index, const RunRecord& record);
  /// Marks a run as not needed, permanently. Must be called between rounds.
  void spare(std::size_t cell, std::size_t run_index);
  /// The file with the runs stored so far, for reading.
  const std::filesystem::path& unfinished() const { return result_.file.path(); }
  /// Adds to the wall time of all sessions in /timing [s].
  void note_wall_seconds(double seconds);

  /// Flushes all data to the disk. The file remains as OUT.h5.part and can be resumed; an attempt
  /// is renamed to that. Must be called before an early exit.
  void suspend();
  /// Flushes and renames OUT.h5.part to OUT.h5. Throws std::logic_error if a run is missing.
  void finish();
  /// Removes the unfinished file if that is possible, for work without any result. Files of other
  /// attempts remain. Does not throw, so that an error may be under way.
  void discard() noexcept;

 private:
  ResultWriter(const std::filesystem::path& path, OpenResult result, const StudyPlan& plan);
  bool is_finished() const { return result_.file.path() == path_; }
  void write_poses(std::size_t run_index, const Drive& drive, Fingerprint& fingerprint) const;
  void write_landmarks(std::size_t run_index, Fingerprint& fingerprint) const;

  std::filesystem::path path_;  ///< final name of the file
  OpenResult result_;
  bool scans_only_;
  std::vector<std::uint32_t> scan_steps_;
  std::function<std::vector<Eigen::Vector2d>(std::uint64_t)> own_landmarks_;
  std::uint64_t first_run_;
  /// {cell}{run index} status of each run.
  std::vector<std::vector<std::atomic<RunStatus>>> status_;
  std::vector<std::atomic<bool>> truth_stored_;  ///< {run index} whether the true path is stored
};

}  // namespace montecarta::engine
