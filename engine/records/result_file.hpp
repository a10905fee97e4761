// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/columns.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/run_record.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::engine {

/// A result file opened for reading: all that analysis knows of a study. Reads stream run by run.
/// Reading needs no more memory than the caller's buffer. Two threads may read from one file object
/// where the HDF5 library is built thread-safe, as Debian's is. Opens finished files and work in
/// progress (OUT.h5.part). Every member throws StudyError naming file and dataset when the file
/// cannot be read.
class ResultFile {
 public:
  /// Throws StudyError where `path` is missing, no HDF5 file, or no montecarta result of a known
  /// major version.
  explicit ResultFile(const std::filesystem::path& path);
  ~ResultFile();
  ResultFile(ResultFile&&) noexcept;

  const std::filesystem::path& path() const;
  /// All of it in one piece; the members below name its parts.
  const ResultDescription& description() const;
  const std::string& study_name() const;
  const std::string& title() const;
  const std::string& study_text() const;  ///< resolved study file
  const std::string& study_sha256() const;
  std::uint64_t seed() const;
  std::uint64_t study_runs() const;                ///< of the whole study; this file may hold fewer
  const std::vector<std::uint64_t>& runs() const;  ///< run numbers held, the `run` scale
  const std::vector<double>& times() const;        ///< [s] rows of `time`
  const std::vector<std::uint32_t>& scan_rows()
      const;                                      ///< row of `time` at which each scan was taken
  const std::vector<double>& scan_times() const;  ///< [s]
  const std::vector<std::pair<double, double>>& landmarks() const;  ///< [m] true positions
  const std::vector<std::pair<double, double>>& waypoints() const;  ///< [m]
  /// Whether errors are known: true poses are stored, or errors of imported estimates.
  bool has_errors() const;
  const std::vector<ReferencePath>& references() const;  ///< of a recorded drive, else none
  bool has_truth() const;                                ///< whether true poses are stored
  const TextPairs& scenario() const;
  const TextPairs& provenance() const;
  const std::vector<StoredCell>& cells() const;

  std::vector<RunStatus> status(const StoredCell& cell) const;  ///< one per run held
  /// Throws StudyError if the bytes of run index `i` of `cell`, its status and true path included,
  /// do not fit the fingerprints stored with them. A file without a seal, which another program may
  /// have written anew, is not checked. Any number of threads may call it.
  void expect_whole(const StoredCell& cell, std::size_t i) const;
  std::vector<std::string> failure_reasons(const StoredCell& cell) const;
  std::vector<std::uint32_t> failure_steps(const StoredCell& cell) const;
  std::vector<double> cpu_seconds(const StoredCell& cell)
      const;                    ///< [s] of the run's own thread over its steps; NaN where missing
  double wall_seconds() const;  ///< [s] of all sittings

  /// Whether run index `i` has this column, as every run or as one of those stored in full.
  bool holds(const StoredCell& cell, std::string_view column, std::size_t i) const;
  /// Copies {axes of the column} of run index `i` (0-based in this file), converted to double.
  /// `out` must fit.
  void read(const StoredCell& cell, std::string_view column, std::size_t i,
            std::span<double> out) const;
  void read(const StoredCell& cell, std::string_view column, std::size_t i,
            std::span<std::uint32_t> out) const;
  /// {time, 3} of run index i; zeros where no cell of that run is complete or failed yet. Only
  /// where has_truth().
  void read_truth(std::size_t i, std::span<double> out) const;
  /// Whether every run has landmarks of its own.
  bool has_own_landmarks() const;
  /// [m] True positions in run index i, by identity: its own, or the world's; empty where unknown.
  std::vector<Eigen::Vector2d> landmarks_of(std::size_t i) const;

 private:
  struct Contents;
  std::unique_ptr<Contents> contents_;
};

}  // namespace montecarta::engine
