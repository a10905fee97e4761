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

/// What to do where a result of that name is already there.
enum class Existing { refuse, replace };

/// Writes the result file of a plan. Work in progress lies in OUT.h5.part, which any HDF5 reader
/// opens at any moment; finish() gives it its final name. Runs go straight from the caller's thread
/// to their place in the file, the status byte last, so there is no queue, and `kill -9` loses only
/// runs in flight. `run_index` counts from 0 within this file: run number plan.first_run +
/// run_index. Throws StudyError where the user must act before running (result exists, other study,
/// path), RunError where the disk fails.
class ResultWriter {
 public:
  /// Lays out a new file. `existing` also says what happens to an unfinished OUT.h5.part. An OUT.h5
  /// to be replaced stays untouched until finish(). `provenance` (how the file is made) becomes
  /// attributes of /provenance.
  static ResultWriter create(const std::filesystem::path& path, const StudyPlan& plan,
                             const TextPairs& provenance, Existing existing);
  /// Goes on with OUT.h5.part, or finds OUT.h5 finished with nothing missing, or begins where there
  /// is neither. Refuses beside an OUT.h5 of another study or other runs, unless `replace` began
  /// it. Stored runs whose fingerprint does not fit (a power cut) count as missing again.
  static ResultWriter resume(const std::filesystem::path& path, const StudyPlan& plan,
                             const TextPairs& provenance);
  /// One of several attempts at one result, perhaps on a machine that was given up for dead: works
  /// under a name of its own, OUT.h5.part.*, goes on from what others left or still write, checked
  /// and copied, and never disturbs them. The first that is complete becomes OUT.h5. Finds OUT.h5
  /// finished as resume() does.
  static ResultWriter attempt(const std::filesystem::path& path, const StudyPlan& plan,
                              const TextPairs& provenance);
  ~ResultWriter();
  ResultWriter(ResultWriter&&) noexcept;

  /// Whether this run of this cell is in the file. Thread-safe.
  RunStatus status(std::size_t cell, std::size_t run_index) const;
  /// What a user should hear about a resumption ("3 runs were damaged ..."), one sentence each.
  const std::vector<std::string>& notes() const;

  /// Stores the true path of a run, once; call it for every drive made, before write().
  /// Thread-safe.
  void write_truth(std::size_t run_index, const Drive& drive);
  /// Stores a finished run (complete or failed), once. Thread-safe for different (cell, run).
  void write(std::size_t cell, std::size_t run_index, const RunRecord& record);
  /// Marks a run as not needed, for good. Between runs.
  void spare(std::size_t cell, std::size_t run_index);
  /// The file with what is stored so far, to be read.
  const std::filesystem::path& unfinished() const;
  /// Adds to the wall time of all sittings [s] in /timing.
  void note_wall_seconds(double seconds);

  /// Flushes what is written to the disk; the file stays, or as an attempt becomes, OUT.h5.part, to
  /// be resumed. Call before an early exit.
  void suspend();
  /// No run is missing: flushes, renames OUT.h5.part to OUT.h5. Throws std::logic_error where one
  /// is missing.
  void finish();

 private:
  struct Work;
  explicit ResultWriter(std::unique_ptr<Work> work);
  std::unique_ptr<Work> work_;
};

}  // namespace montecarta::engine
