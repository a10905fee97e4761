// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/path_data.hpp"

#include "analysis/data/run_reader.hpp"
#include "analysis/figures/stored_map.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

/// In how many cells each run is complete.
std::vector<std::size_t> completeness(const ResultFile& file) {
  std::vector<std::size_t> cells(file.runs().size());
  for (const StoredCell& cell : file.cells()) {
    const auto status = file.status(cell);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cells[i] += status[i] == RunStatus::complete ? 1 : 0;
    }
  }
  return cells;
}

constexpr std::size_t kMostPoints = 500;
constexpr std::size_t kMostRecorded = 1500;  // a recorded drive is kilometres long
constexpr std::size_t kMostFixes = 600;

const std::vector<std::string> kEllipseHeadings = {"x [m]", "y [m]", "major diameter [m]",
                                                   "minor diameter [m]", "angle [deg]"};

std::vector<double> ellipse_row(const Ellipse& e) { return {e.x, e.y, e.major, e.minor, e.angle}; }

FigureData recorded_path(const ResultFile& file, const StoredCell& cell, const RunRows& run) {
  FigureData data{"path_" + cell.label + ".csv", {"time [s]", "x [m]", "y [m]"}, {}};
  const auto times = drive_met_by(file, run.run).scan_times;
  const auto& mean = estimate_of(run).mean;
  const std::size_t stride = 1 + times.size() / kMostRecorded;
  for (std::size_t s = 0; s < times.size(); s += stride) {
    data.rows.push_back({times[s], mean[3 * s], mean[3 * s + 1]});
  }
  return data;
}

}  // namespace

std::optional<std::size_t> chosen_run(const ResultFile& file, std::optional<std::uint64_t> run) {
  if (run) {
    const auto found = std::ranges::find(file.runs(), *run);
    if (found == file.runs().end()) {
      throw StudyError(file.path().string() + ": run " + std::to_string(*run) +
                       " (the file does not hold it): choose another with --run");
    }
    return static_cast<std::size_t>(found - file.runs().begin());
  }
  const auto cells = completeness(file);
  const auto best = std::ranges::max_element(cells);
  if (best == cells.end() || *best == 0) return std::nullopt;
  return static_cast<std::size_t>(best - cells.begin());
}

FigureData path_data(const ResultFile& file, const StoredCell& cell, const RunRows& run) {
  if (run.truth.empty()) return recorded_path(file, cell, run);
  FigureData data{"path_" + cell.label + ".csv",
                  {"time [s]", "true x [m]", "true y [m]", "x [m]", "y [m]"},
                  {}};
  const auto& times = file.scan_times();
  const auto& mean = estimate_of(run).mean;
  const std::size_t stride = 1 + times.size() / kMostPoints;
  for (std::size_t s = 0; s < times.size(); s += stride) {
    data.rows.push_back(
        {times[s], run.truth[3 * s], run.truth[3 * s + 1], mean[3 * s], mean[3 * s + 1]});
  }
  return data;
}

FigureData pose_ellipses(const StoredCell& cell, const RunRows& run) {
  FigureData data{"pose_ellipses_" + cell.label + ".csv", kEllipseHeadings, {}};
  const MomentRows& moments = estimate_of(run);
  const std::size_t scans = moments.covariance.size() / 9;
  const std::size_t ellipses = std::min(kPoseEllipses, scans);
  for (std::size_t k = 1; k <= ellipses; ++k) {
    const std::size_t s = k * scans / ellipses - 1;
    const double* P = moments.covariance.data() + 9 * s;
    data.rows.push_back(ellipse_row(
        two_sigma_ellipse(moments.mean[3 * s], moments.mean[3 * s + 1], P[0], P[3], P[4])));
  }
  return data;
}

FigureData map_data(const ResultFile& file, const StoredCell& cell, std::size_t run_index) {
  FigureData data{"map_" + cell.label + ".csv", kEllipseHeadings, {}};
  const StoredMap map(file, cell, run_index);
  if (map.scans() == 0) return data;
  for (const Ellipse& ellipse : map.at(map.scans() - 1)) data.rows.push_back(ellipse_row(ellipse));
  return data;
}

FigureData fix_data(const ResultFile& file, std::size_t run_index) {
  const auto references = drive_met_by(file, file.runs()[run_index]).references;
  if (references.empty()) return {"fixes.csv", {"time [s]", "x [m]", "y [m]"}, {}};
  const ReferencePath& path = references.front();
  FigureData data{"fixes_" + path.name + ".csv", {"time [s]", "x [m]", "y [m]"}, {}};
  const std::size_t stride = 1 + path.time.size() / kMostFixes;
  for (std::size_t f = 0; f < path.time.size(); f += stride) {
    data.rows.push_back({path.time[f], path.position[f].x(), path.position[f].y()});
  }
  return data;
}

FigureData landmark_data(const ResultFile& file, std::size_t run_index) {
  FigureData data{"landmarks.csv", {"x [m]", "y [m]"}, {}};
  for (const auto& at : file.landmarks_of(run_index)) data.rows.push_back({at.x(), at.y()});
  return data;
}

}  // namespace montecarta::analysis
