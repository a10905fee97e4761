// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_writer.hpp"
#include "tests/doubles/recorded_drives.hpp"
#include "tests/doubles/scripted_result.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// A cell of the recorded study: its estimates run in small circles around the true path, so that
/// every error is `radius` [m] long and alignment takes away no part of it but `shift` [m].
struct RecordedCell {
  std::string label, filter;
  std::size_t particles;
  double radius;          ///< [m] of run 0; every run is 2 % worse than the one before
  double shift;           ///< [m] along x
  std::ptrdiff_t lost;    ///< run with circles of 40 m; -1: none
  std::ptrdiff_t failed;  ///< run that fails at step 5; -1: none
};

inline const std::vector<RecordedCell>& recorded_cells() {
  static const std::vector<RecordedCell> cells = {
      {"ekf_slam", "ekf_slam", 0, 1.0, 0.0, -1, -1},
      {"fastslam2_m3", "fastslam2", 3, 2.0, 3.0, 1, -1},
      {"fastslam2_m20", "fastslam2", 20, 0.5, 3.0, -1, -1},
      {"ufastslam_m3", "ufastslam", 3, 0.8, 0.0, -1, 3}};
  return cells;
}

inline StudyPlan recorded_plan(std::uint64_t runs, std::size_t steps) {
  StudyPlan plan = scripted_study(runs, steps);
  plan.name = "recorded";
  plan.title = "A drive that somebody recorded";
  plan.columns = {.final_map = true};
  plan.drives = std::make_shared<RecordedDrives>(steps);
  for (const RecordedCell& cell : recorded_cells()) {
    plan.cells.push_back(scripted_cell(
        cell.label, {.particles = std::max<std::size_t>(1, cell.particles), .landmarks = 20}));
    plan.cells.back().filter = cell.filter;
    plan.cells.back().particles = cell.particles;
  }
  return plan;
}

/// Overwrites a record's estimates as its cell says.
inline void put_path(const RecordedDrives& drives, const RecordedCell& cell, std::uint64_t run,
                     RunRecord& record) {
  const bool lost = static_cast<std::ptrdiff_t>(run) == cell.lost;
  const double radius = lost ? 40.0 : cell.radius * (1.0 + 0.02 * static_cast<double>(run));
  const auto mean = record.column<double>(*record.layout().find("pose_mean_mixture"));
  const auto& times = drives.itinerary().step_time;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const Pose pose = drives.pose_at(times[k]);
    const double turn = 20.0 * kTwoPi * times[k] / times.back();
    mean[3 * k] = pose.x + cell.shift + radius * std::cos(turn);
    mean[3 * k + 1] = pose.y + radius * std::sin(turn);
    mean[3 * k + 2] = wrap(pose.heading + 0.1);
  }
}

/// Overwrites a record's maps, which lie as far off as the path: three of four beacons another 0.3
/// m off, one 5 m off, one landmark that is none; the map grows by one landmark in ten scans up
/// to 20.
inline void put_map(const RecordedDrives& drives, const RecordedCell& cell, RunRecord& record) {
  const auto mean = record.column<double>(*record.layout().find("final_map_mean"));
  const auto seen = record.column<std::uint8_t>(*record.layout().find("final_map_seen"));
  const auto size = record.column<double>(*record.layout().find("map_size"));
  const auto& beacons = drives.itinerary().landmarks;
  std::ranges::fill(seen, std::uint8_t{0});
  for (std::size_t l = 0; l < 5; ++l) {
    const Eigen::Vector2d place = l < 4 ? beacons[l] : Eigen::Vector2d(0.0, -70.0);
    mean[2 * l] = place.x() + cell.shift + (l == 3 ? 5.0 : 0.3);
    mean[2 * l + 1] = place.y();
    seen[l] = 1;
  }
  mean[10] = beacons[3].x() + cell.shift;  // not in the map
  mean[11] = beacons[3].y();
  for (std::size_t s = 0; s < size.size(); ++s) {
    size[s] = std::min(20.0, std::floor(static_cast<double>(s) / 10.0));
  }
}

/// A finished result of all recorded_cells().
inline void write_recorded_result(const std::filesystem::path& path, std::uint64_t runs = 4,
                                  std::size_t steps = 1200) {
  const StudyPlan plan = recorded_plan(runs, steps);
  const RecordedDrives drives(steps);
  ResultWriter writer = ResultWriter::create(path, plan, {{"host", "nowhere"}}, Existing::replace);
  Drive drive;
  for (std::uint64_t run = 0; run < runs; ++run) {
    drives.generate(run, drive);
    writer.write_truth(run, drive);
    for (std::size_t c = 0; c < plan.cells.size(); ++c) {
      const RecordLayout layout(plan.cells[c], plan.columns, drives.itinerary());
      RunRecord record(layout);
      fill_record(plan, c, run, drive, record);
      put_path(drives, recorded_cells()[c], run, record);
      put_map(drives, recorded_cells()[c], record);
      if (static_cast<std::ptrdiff_t>(run) == recorded_cells()[c].failed) {
        record.mark_failed(5, "the map has more than 1000 landmarks", 1.0);
      }
      writer.write(c, run, record);
    }
  }
  writer.finish();
}

}  // namespace montecarta::analysis
