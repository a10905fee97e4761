// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/plan.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/run_record.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace montecarta::engine {

/// The treatment of an existing file of the same name.
enum class Existing { refuse, replace };

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
  ~ResultWriter();
  ResultWriter(ResultWriter&&) noexcept;

  /// Status of this run of this cell in the file. Thread-safe.
  RunStatus status(std::size_t cell, std::size_t run_index) const;
  /// Messages for the user about a resumption ("3 runs were damaged ..."), one sentence each.
  const std::vector<std::string>& notes() const;

  /// Stores the true path of a run. Must be called once for every drive, before write().
  /// Thread-safe.
  void write_truth(std::size_t run_index, const Drive& drive);
  /// Stores a finished run (complete or failed), once. Thread-safe for different (cell, run).
  void write(std::size_t cell, std::size_t run_index, const RunRecord& record);
  /// Marks a run as not needed, permanently. Must be called between rounds.
  void spare(std::size_t cell, std::size_t run_index);
  /// The file with the runs stored so far, for reading.
  const std::filesystem::path& unfinished() const;
  /// Adds to the wall time of all sessions in /timing [s].
  void note_wall_seconds(double seconds);

  /// Flushes all data to the disk. The file remains as OUT.h5.part and can be resumed; an attempt
  /// is renamed to that. Must be called before an early exit.
  void suspend();
  /// Flushes and renames OUT.h5.part to OUT.h5. Throws std::logic_error if a run is missing.
  void finish();

 private:
  struct Work;
  explicit ResultWriter(std::unique_ptr<Work> work);
  std::unique_ptr<Work> work_;
};

}  // namespace montecarta::engine
