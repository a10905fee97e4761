// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/run_rows.hpp"
#include "engine/records/result_file.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace montecarta::analysis {

/// The drive of one run: views into a file's description.
struct RunDrive {
  std::span<const double> scan_times;         ///< [s] {scan} time of each scan
  std::span<const std::uint32_t> scan_steps;  ///< {scan} step after which the scan was taken
  std::span<const double> row_times;          ///< [s] {row} time of each row of estimates
  std::span<const std::uint32_t> scan_rows;   ///< {scan} row of each scan
  Pose start;                                 ///< pose before the first step
  std::span<const ReferencePath> references;  ///< references of a recorded drive
};

/// The drive of run number `run` of the study, even if the file does not hold that run. The file
/// must outlive it.
inline RunDrive drive_of_run(const ResultFile& file, std::uint64_t run) {
  const ResultDescription& all = file.description();
  if (all.drives.empty()) {
    return {all.scan_times, all.scan_steps, all.times, all.scan_rows, all.start, all.references};
  }
  const OwnDrive& own = all.drives.at(run);
  const bool has_steps = !own.step_times.empty();
  const auto scans = std::span(all.scan_rows).first(own.scan_times.size());
  return {own.scan_times,
          own.scan_steps,
          has_steps ? own.step_times : own.scan_times,
          has_steps ? own.scan_steps : scans,
          own.start,
          own.references};
}

/// The scans of a study that are judged: those at study.judge_from [s] or later. The analysis reads
/// no others; figures of one run show all.
struct JudgedScans {
  double from = 0.0;      ///< [s] time from which scans are judged
  std::size_t first = 0;  ///< number of the first judged scan
};

/// The judged scans of a file. Throws StudyError if there are none, or if a file that has them has
/// drives of its own, whose scans are at other times.
JudgedScans judged_scans_of(const ResultFile& file);

/// The scans of ResultDescription::joint_scans that are judged, counted from the first judged one.
std::vector<std::uint32_t> judged_joint_scans(const ResultFile& file);

/// The columns that are read: those stored for every run, or all that are stored for a run in full.
enum class Reach : std::uint8_t { every_run, full_run };

/// Reads the runs of one cell at its scans: those that are judged, or all of runs in full. Any
/// number of threads may call read(), each with its own rows. The file and the cell must outlive
/// it.
class RunReader {
 public:
  RunReader(const ResultFile& file, const StoredCell& cell, Reach reach = Reach::every_run);

  /// Number of particles of the cell; 0 if it has none.
  std::size_t particles() const { return cell_->particles; }

  /// Fills `rows` from run index `i` (0-based in the file), which must be complete. Throws
  /// StudyError if the run is damaged (ResultFile::expect_whole()).
  void read(std::size_t i, RunRows& rows) const;

 private:
  /// Returns whether run index `i` has the column and Reach allows it to be read.
  bool has(std::string_view column, std::size_t i) const;
  void read_truth(std::size_t i, RunRows& rows) const;
  /// Reads the estimates at all rows, if the drive has references.
  void read_path(std::size_t i, PathRows& out) const;
  /// Reads the map after the last scan, also from columns that hold the map of every scan.
  void read_final_map(std::size_t i, RunRows& rows) const;
  /// Reads all rows of a column over time; `width` numbers a row. Empty if it is not stored.
  void read_rows(std::string_view column, std::size_t width, std::size_t i,
                 std::vector<double>& out) const;
  /// Reads the scans of a column over time; `width` numbers a row. Empty if it is not stored.
  void read_at_scans(std::string_view column, std::size_t width, std::size_t i,
                     std::vector<double>& out) const;
  /// Reads a whole column, as far as it is stored.
  void read_whole(std::string_view column, std::size_t i, std::vector<double>& out) const;
  /// Reads a column without its first `left_out` rows of `width` numbers.
  void read_without(std::string_view column, std::size_t left_out, std::size_t width, std::size_t i,
                    std::vector<double>& out) const;
  /// Reads the estimates of pose and map together at the judged scans that have them.
  void read_joint(std::size_t i, JointRows& out) const;
  /// Reads imported errors.
  void read_errors(std::size_t i, ErrorRows& out) const;
  /// Reads weights, parents and poses of the particles; empty if the cell has none.
  void read_particles(std::size_t i, RunRows& rows) const;
  /// Throws StudyError where a parent does not exist.
  void expect_particles(const RunRows& rows) const;
  template <class Number>
  void read_scans(std::string_view column, std::size_t width, std::size_t i,
                  std::vector<Number>& out) const;
  /// Number of scans of run index `i`, judged or not. A drive of its own may have fewer scans than
  /// the file.
  std::size_t scans_of(std::size_t i) const;
  /// Keeps, of rows of `width` numbers, those at the scans of run index `i` that are read.
  void keep_scans(std::size_t width, std::size_t i, std::vector<double>& rows) const;

  const ResultFile* file_;
  const StoredCell* cell_;
  Reach reach_;
  std::size_t first_;        ///< first scan that is read
  std::size_t first_joint_;  ///< first scan with a joint estimate that is read
  std::vector<double> cpu_seconds_;
};

/// Reads run index `i` alone, with the columns that are stored only for runs in full.
RunRows read_run(const ResultFile& file, const StoredCell& cell, std::size_t i);

}  // namespace montecarta::analysis
