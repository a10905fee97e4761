// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/run_record.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::engine {

/// One run of one cell in a file.
struct StoredRun {
  std::size_t cell;       ///< index in the file, and in the plan
  std::size_t run_index;  ///< index within the file
};

/// Computes stored runs again, each by itself, and compares all bytes under /cells and /truth.
class Recomputation {
 public:
  /// `stored` is the description of the file at `path`, and `plan` is the plan of its study. Both
  /// must outlive the object. Throws StudyError if the plan defines another layout.
  Recomputation(const std::filesystem::path& path, const ResultDescription& stored,
                const StudyPlan& plan);

  /// Describes the difference of a run that is stored as complete or failed, worded for the user;
  /// nullopt if all bytes are equal. Thread-safe.
  std::optional<std::string> difference(StoredRun which) const;

 private:
  std::optional<std::string> difference(const Drive& drive, std::size_t run_index) const;
  std::optional<std::string> difference(const RunRecord& record, StoredRun which) const;

  const ResultDescription& stored_;
  const StudyPlan& plan_;
  PosixFile file_;
  ResultSlabs slabs_;
  /// {cell} layouts of usual runs, and of runs in full.
  std::vector<RecordLayout> layouts_, full_layouts_;
};

}  // namespace montecarta::engine
