// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/records/run_record.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace montecarta::engine {

/// Copies the data of a filter that the layout contains into a record. The calls follow the filter:
/// predict(), then update() and after_scan() if the step ends with a scan, then after_step().
/// Columns that are not stored are not computed. There is one recorder for each worker and cell; it
/// allocates nothing after construction. The record must outlive it.
class Recorder {
 public:
  explicit Recorder(RunRecord& record);

  /// Sets the number of scans of the next run, if it has fewer than the layout. The final map is
  /// stored at the last of them.
  void expect_scans(std::size_t scans) { scans_ = scans; }

  /// Writes row `step` of the columns over time, unless their rows are scans. Returns the recorded
  /// estimate, so that the caller can check it without computing it again; nullptr if none was
  /// recorded.
  const PoseEstimate* after_step(const SlamFilter& filter, std::size_t step);
  /// Writes row `scan` of the columns over scans, and over time if those rows are scans. Returns
  /// the same as after_step().
  const PoseEstimate* after_scan(const SlamFilter& filter, std::size_t scan);

 private:
  /// Columns of a map; empty if they are not stored.
  struct MapColumns {
    std::span<double> mean, covariance;
    std::span<std::uint8_t> seen;
  };
  struct Columns {
    std::span<double> pose_mean, pose_covariance, pose_mean_mixture, pose_covariance_mixture;
    std::span<double> particle_pose, log_weight;
    std::span<std::uint32_t> ancestor_wide;
    std::span<std::uint16_t> ancestor_narrow;
    MapColumns map, final_map;
    std::span<double> joint_mean, joint_covariance;
    std::span<std::uint32_t> numerical_faults;
  };

  /// A number that the filter reports at every scan.
  struct Reported {
    double (*value)(const ScanReport&);
    std::variant<std::span<double>, std::span<std::uint8_t>, std::span<std::uint32_t>> column;
  };

  /// A column that the filter declares itself.
  struct Own {
    std::size_t index;  ///< index in ScanReport::own
    std::span<double> column;
  };

  void find_reported(RunRecord& record);
  void find_own(RunRecord& record);
  void choose_ancestor(RunRecord& record);
  const PoseEstimate* record_pose(const SlamFilter& filter, std::size_t row);
  void record_report(const ScanReport& report, std::size_t scan);
  void record_particles(const SlamFilter& filter, std::size_t scan);
  void record_map(const SlamFilter& filter, std::size_t scan);
  void record_joint(const SlamFilter& filter, std::size_t scan);
  void write_map(const MapColumns& columns, std::size_t row) const;

  const RecordLayout* layout_;
  std::size_t scans_;  ///< number of scans of this run
  Columns columns_;
  std::vector<Reported> reported_;
  std::vector<Own> own_;
  PoseEstimate estimate_;                 ///< the last recorded estimate
  std::vector<std::uint32_t> ancestors_;  ///< ancestors of one scan, before narrowing to 16 bits
  std::vector<std::optional<LandmarkEstimate>> landmarks_;  ///< map of one scan
};

}  // namespace montecarta::engine
