// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "experiments/recordings/drive_log.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The folder that a study means by `path`: below one of `folders`, or as it is, or below a folder
/// of the environment variable MONTECARTA_DATA (separated by colons). Throws StudyError where there
/// is none.
std::filesystem::path find_recording(const std::string& path,
                                     const std::vector<std::filesystem::path>& folders);

/// The folders that a list names, separated by commas; where a folder has commas in its name, and
/// is there, it is one.
std::vector<std::string> recordings_in(const std::string& list,
                                       const std::vector<std::filesystem::path>& folders);

/// SHA-256 of all that a log says, hexadecimal: whatever files it came in, the same drive has the
/// same one.
std::string fingerprint_of(const DriveLog& log);

/// A recorded drive as the engine takes it: odometry, scans and fixes merged by their times, which
/// are counted from the start. A step ends wherever odometry or a scan comes in, so that no
/// step has two scans, and drives by the odometry that came in last. Before the first odometry the
/// vehicle stands. Scans that a delay puts before the start are taken there. All runs are the same:
/// they differ by the filter's random numbers alone.
class RecordedDrive final : public DriveSource {
 public:
  /// Distances [m] of detections that are used, as far as detections say how far they are.
  struct Reach {
    double max_range;
    double min_range = 0.0;
  };
  /// Scans happened `scan_delay` [s] before the log has them (a laser scanner takes its time to
  /// send). The log must have passed check_log().
  RecordedDrive(const DriveLog& log, const Reach& reach, double scan_delay = 0.0);

  const Itinerary& itinerary() const override { return itinerary_; }
  void generate(std::uint64_t run, Drive& drive) const override;

 private:
  void merge(const DriveLog& log, const Reach& reach, double scan_delay);
  void end_step(double time, const Control& control);
  void take_scan(const LoggedScan& scan, std::span<const Quantity> components, const Reach& reach);

  Itinerary itinerary_;
  Drive drive_;
};

/// Several recorded drives of one scenario: run k meets drive k. Their lengths, starts and fixes
/// are their own; references have the same names and tell the same of themselves, and surveyed
/// landmarks are those of all.
class SeveralDrives final : public DriveSource {
 public:
  /// As RecordedDrive has them; at least one. Throws StudyError where two do not belong together.
  explicit SeveralDrives(std::vector<RecordedDrive> drives);

  const Itinerary& itinerary() const override { return itinerary_; }
  std::size_t own_drives() const override { return drives_.size(); }
  const Itinerary& itinerary_of(std::uint64_t run) const override;
  void generate(std::uint64_t run, Drive& drive) const override;

 private:
  std::vector<RecordedDrive> drives_;
  Itinerary itinerary_;  ///< of the drive with most scans, without references
};

/// Whether a log tells which landmark each detection is of.
enum class Identities { told, withheld };

/// A drive with known truth as if it had been recorded: RecordedDrive makes the same steps,
/// controls and scans of it, bit for bit, while no detection is beyond its max_range. Times count
/// from the start. The truth after every step is its only reference, `landmarks` its survey,
/// `controls` what its controls are.
DriveLog log_of(const Itinerary& itinerary, const Drive& drive, std::span<const Quantity> controls,
                std::vector<Eigen::Vector2d> landmarks, Identities identities);

}  // namespace montecarta::experiments
