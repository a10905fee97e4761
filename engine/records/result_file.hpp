// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/columns.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace montecarta {

enum class RunStatus : std::uint8_t { missing = 0, complete = 1, failed = 2 };

/// A cell as a result file describes it.
struct StoredCell {
  std::string label;
  std::string filter;
  std::string long_name;
  std::size_t particles = 0;
  std::vector<std::pair<std::string, std::string>> settings;
  std::vector<Column> columns;  ///< what was stored
  bool has(std::string_view column) const;
};

/// A result file opened for reading: all that analysis knows of a study. Reads stream run by run.
/// Every member throws RunError naming file and dataset when the file cannot be read.
class ResultFile {
 public:
  /// Throws StudyError where `path` is missing, no HDF5 file, or no montecarta result of a known
  /// major version.
  explicit ResultFile(const std::filesystem::path& path);
  ~ResultFile();
  ResultFile(ResultFile&&) noexcept;
  ResultFile& operator=(ResultFile&&) noexcept;

  const std::filesystem::path& path() const;
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
  const std::vector<std::pair<std::string, std::string>>& scenario() const;
  const std::vector<std::pair<std::string, std::string>>& provenance() const;
  const std::vector<StoredCell>& cells() const;

  std::vector<RunStatus> status(const StoredCell& cell) const;  ///< one per run held
  std::vector<std::string> failure_reasons(const StoredCell& cell) const;
  std::vector<std::uint32_t> failure_steps(const StoredCell& cell) const;
  std::vector<double> cpu_seconds(
      const StoredCell& cell) const;  ///< filter only; NaN where missing

  /// Copies {axes of the column} of run index `i` (0-based in this file), converted to double.
  /// `out` must fit.
  void read(const StoredCell& cell, std::string_view column, std::size_t i,
            std::span<double> out) const;
  void read(const StoredCell& cell, std::string_view column, std::size_t i,
            std::span<std::uint32_t> out) const;
  /// {time, 3} of run index i.
  void read_truth(std::size_t i, std::span<double> out) const;

 private:
  struct Contents;
  std::unique_ptr<Contents> contents_;
};

}  // namespace montecarta
