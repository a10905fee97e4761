// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/run_record.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::engine {

struct SumGroup;

/// A result file that is opened for reading, the input of all analyses. Runs are read one by one,
/// so that no more memory than the caller's buffer is needed. Any number of threads may call the
/// members that take the index of a run. Opens finished files and unfinished work (OUT.h5.part).
/// Members throw StudyError with file and dataset if the file is damaged, and RunError if the disk
/// fails or a column is not stored.
class ResultFile {
 public:
  /// Opens a file. Throws StudyError if `path` does not exist, is no HDF5 file, or is no montecarta
  /// result of a known major version.
  explicit ResultFile(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  /// The whole description. The members below give access to its parts.
  const ResultDescription& description() const { return description_; }
  const std::string& study_name() const { return description_.study_name; }
  const std::string& title() const { return description_.title; }
  const std::string& study_text() const { return description_.study_text; }
  const std::string& study_sha256() const { return description_.study_sha256; }
  std::uint64_t seed() const { return description_.seed; }
  std::uint64_t study_runs() const { return description_.study_runs; }
  const std::vector<std::uint64_t>& runs() const { return description_.runs; }
  const std::vector<double>& times() const { return description_.times; }
  const std::vector<std::uint32_t>& scan_rows() const { return description_.scan_rows; }
  const std::vector<double>& scan_times() const { return description_.scan_times; }
  const std::vector<Eigen::Vector2d>& landmarks() const { return description_.landmarks; }
  const std::vector<Eigen::Vector2d>& waypoints() const { return description_.waypoints; }
  const std::vector<ReferencePath>& references() const { return description_.references; }
  bool has_truth() const { return description_.has_truth; }
  const TextPairs& scenario() const { return description_.scenario; }
  const TextPairs& provenance() const { return description_.provenance; }
  const std::vector<StoredCell>& cells() const { return description_.cells; }
  /// Returns whether errors are known, from true poses or from imported estimates.
  bool has_errors() const;

  /// {run of the file} status of each run.
  std::vector<RunStatus> status(const StoredCell& cell) const;
  /// Throws StudyError if the bytes of run index `i` of `cell`, including its status and true path,
  /// do not match the stored fingerprints. The runs of a file without a seal were compared with
  /// them when it was opened.
  void expect_whole(const StoredCell& cell, std::size_t i) const;
  std::vector<std::string> failure_reasons(const StoredCell& cell) const;
  std::vector<std::uint32_t> failure_steps(const StoredCell& cell) const;
  /// Processor time of each run's own thread over its steps [s]; NaN if missing.
  std::vector<double> cpu_seconds(const StoredCell& cell) const;
  double wall_seconds() const;  ///< [s] wall time of all sessions
  /// XXH3 of the stored data of each run.
  std::vector<std::uint64_t> fingerprints(const StoredCell& cell) const;

  /// Returns whether the file has sums over groups of runs. Then the members above are of the first
  /// runs.
  bool has_sums() const { return description_.sums.has_value(); }
  std::vector<SumGroup> sum_groups(const StoredCell& cell) const;
  /// The sums over a group. Any number of threads may call it.
  std::vector<std::uint64_t> sums(const SumGroup& group) const;
  /// Processor time of every run in the sums [s].
  std::vector<double> cpu_seconds_in_sums(const StoredCell& cell) const;

  /// Returns whether run index `i` has this column, because every run has it or this one is stored
  /// in full.
  bool holds(const StoredCell& cell, std::string_view column, std::size_t i) const;
  /// Reads the column of run index `i` (from 0 in this file), converted to double. `out` must have
  /// its size.
  void read(const StoredCell& cell, std::string_view column, std::size_t i,
            std::span<double> out) const;
  void read(const StoredCell& cell, std::string_view column, std::size_t i,
            std::span<std::uint32_t> out) const;
  /// Reads {time, 3} of run index i; zeros if no cell of that run is complete or failed yet.
  /// Requires has_truth().
  void read_truth(std::size_t i, std::span<double> out) const;
  /// Returns whether every run has its own landmarks.
  bool has_own_landmarks() const { return description_.own_landmarks; }
  /// True positions [m] of the landmarks in run index i, by identity; empty if unknown.
  std::vector<Eigen::Vector2d> landmarks_of(std::size_t i) const;

 private:
  std::size_t index_of(const StoredCell& cell) const;
  /// All values of a dataset with one value for each run.
  template <class T>
  std::vector<T> per_run(const std::string& dataset, Element element) const;
  template <class Number>
  void read_column(const StoredCell& cell, std::string_view column, std::size_t i,
                   std::span<Number> out) const;
  /// Reads run index `i` of a dataset. If the file has a seal, the numbers are at `slab`, and are
  /// of type `element`.
  template <class Number>
  void read_row(const std::string& dataset, const Slab* slab, Element element, std::size_t i,
                std::span<Number> out) const;

  std::filesystem::path path_;
  bool has_seal_;
  h5::Handle file_;
  PosixFile bytes_;
  ResultDescription description_;
  /// The slabs; nullopt if the file has no seal. Then another program may have rewritten it, and
  /// HDF5 reads all numbers.
  std::optional<ResultSlabs> slabs_;
  mutable std::map<std::string, h5::Handle> datasets_;  ///< datasets of which HDF5 has read rows
};

}  // namespace montecarta::engine
