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

/// The folder that a study names: `path` below one of `folders`, the path itself, or `path` below a
/// folder of the environment variable MONTECARTA_DATA (separated by colons). Throws StudyError if
/// there is none.
std::filesystem::path find_recording(const std::string& path,
                                     const std::vector<std::filesystem::path>& folders);

/// The folders in a list that is separated by commas. An existing folder with commas in its name
/// counts as one.
std::vector<std::string> recordings_in(const std::string& list,
                                       const std::vector<std::filesystem::path>& folders);

/// SHA-256 of all numbers of a log, hexadecimal. It depends on the drive alone, not on its files.
std::string fingerprint_of(const DriveLog& log);

/// A recorded drive in the form of the engine: odometry, scans and fixes are merged by their times,
/// which are counted from the start. A step ends at every odometry record and every scan, so that
/// no step has two scans, and its control is the last odometry before. The vehicle stands still
/// before the first odometry. Scans that a delay moves before the start are taken at the start. All
/// runs are the same drive and differ in the filter's random numbers only.
class RecordedDrive final : public DriveSource {
 public:
  /// Limits of the distance [m] of detections. Detections without a distance are always used.
  struct LogReach {
    double max_range;
    double min_range = 0.0;
  };
  /// Moves all scans by `scan_delay` [s] before their times in the log, because a laser scanner
  /// needs time to send a scan.
  RecordedDrive(const DriveLog& log, const LogReach& reach, double scan_delay = 0.0);

  const Itinerary& itinerary() const override { return itinerary_; }
  void generate(std::uint64_t run, Drive& drive) const override;

 private:
  void merge(const DriveLog& log, const LogReach& reach, double scan_delay);
  void end_step(double time, const Control& control);
  void take_scan(const LoggedScan& scan, std::span<const Quantity> components,
                 const LogReach& reach);

  Itinerary itinerary_;
  Drive drive_;
};

/// Several recorded drives of one scenario: run k uses drive k. Drives may differ in length, start
/// and fixes. Their references have the same names and the same kinds of columns. They share the
/// surveyed landmarks.
class SeveralDrives final : public DriveSource {
 public:
  /// `drives` holds at least one drive. Throws StudyError if two drives do not belong together.
  explicit SeveralDrives(std::vector<RecordedDrive> drives);

  const Itinerary& itinerary() const override { return itinerary_; }
  std::size_t own_drives() const override { return drives_.size(); }
  const Itinerary& itinerary_of(std::uint64_t run) const override;
  void generate(std::uint64_t run, Drive& drive) const override;

 private:
  std::vector<RecordedDrive> drives_;
  /// The itinerary of the drive with the most scans, without references. Its steps are continued to
  /// the number of steps of the drive with the most steps.
  Itinerary itinerary_;
};

/// Whether a log contains the identities of its detections.
enum class Identities { told, withheld };

/// Converts a drive with known truth to a log. RecordedDrive makes the same steps, controls and
/// scans of it, bit for bit, if no detection is beyond its max_range. Times count from the start.
/// The only reference is the truth after every step. `landmarks` are the surveyed landmarks,
/// `controls` the components of the controls.
DriveLog log_of(const Itinerary& itinerary, const Drive& drive, std::span<const Quantity> controls,
                std::vector<Eigen::Vector2d> landmarks, Identities identities);

}  // namespace montecarta::experiments
