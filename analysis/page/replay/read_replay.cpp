// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/run_reader.hpp"
#include "analysis/figures/path_data.hpp"
#include "analysis/figures/stored_map.hpp"
#include "analysis/page/replay/replay.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace montecarta::analysis {
namespace {

using Scans = std::vector<std::size_t>;

/// Scans of the frames: every so many, the last one included.
Scans frame_scans(std::size_t scans, std::size_t most) {
  const std::size_t stride = (scans + most - 1) / std::max<std::size_t>(most, 1);
  Scans frames;
  for (std::size_t s = scans; s > 0; s -= std::min(s, stride)) frames.push_back(s - 1);
  std::ranges::reverse(frames);
  return frames;
}

std::vector<double> component(const std::vector<double>& rows, std::size_t which,
                              const Scans& frames) {
  std::vector<double> values;
  if (rows.empty()) return values;
  for (const std::size_t s : frames) values.push_back(rows[3 * s + which]);
  return values;
}

std::vector<Ellipse> pose_ellipses_at(const MomentRows& moments, const Scans& frames) {
  std::vector<Ellipse> ellipses;
  if (moments.covariance.empty()) return ellipses;
  for (const std::size_t s : frames) {
    const double* P = moments.covariance.data() + 9 * s;
    ellipses.push_back(
        two_sigma_ellipse(moments.mean[3 * s], moments.mean[3 * s + 1], P[0], P[3], P[4]));
  }
  return ellipses;
}

/// Ancestors of a failed run are zeros behind its end, which is a particle like any other.
ReplayParticles read_particles(const ResultFile& file, const StoredCell& cell, std::size_t run,
                               const RunRows& rows, const Scans& frames, std::size_t most) {
  if (cell.particles == 0 || !cell.has("particle_pose")) return {};
  std::vector<double> pose(file.scan_times().size() * cell.particles * 3);
  file.read(cell, "particle_pose", run, std::span(pose));
  return thin_particles({cell.particles, pose, rows.ancestor}, frames, most);
}

/// Why a run failed; empty where it is complete.
std::string failure_of(const ResultFile& file, const StoredCell& cell, std::size_t run) {
  if (file.status(cell)[run] != RunStatus::failed) return "";
  return "failed at step " + std::to_string(file.failure_steps(cell)[run]) + ": " +
         file.failure_reasons(cell)[run];
}

ReplayCell read_cell(const ResultFile& file, std::size_t index, std::size_t run,
                     const Scans& frames, const ReplaySize& size) {
  const StoredCell& cell = file.cells()[index];
  const RunRows rows = read_run(file, cell, run);
  const MomentRows& moments = estimate_of(rows);
  ReplayCell replay{cell.label, index, failure_of(file, cell, run)};
  replay.x = component(moments.mean, 0, frames);
  replay.y = component(moments.mean, 1, frames);
  replay.h = component(moments.mean, 2, frames);
  replay.pose = pose_ellipses_at(moments, frames);
  replay.particles = read_particles(file, cell, run, rows, frames, size.particles);
  replay.has_ancestry = !rows.ancestor.empty();
  replay.maps = read_maps(file, cell, run, frames, size.ellipses);
  return replay;
}

/// The share of one cell of what all have together.
ReplaySize share_of(const ReplaySize& size, std::size_t cells, std::size_t frames) {
  ReplaySize share = size;
  share.particles =
      std::min(std::max<std::size_t>(size.positions / (cells * frames), 8), size.particles);
  share.ellipses = size.ellipses / cells;
  return share;
}

void add_surroundings(const ResultFile& file, std::size_t run, const Scans& frames,
                      Replay& replay) {
  const auto times = drive_met_by(file, file.runs()[run]).scan_times;
  for (const std::size_t s : frames) replay.times.push_back(times[s]);
  for (const auto& row : landmark_data(file, run).rows)
    replay.landmarks.emplace_back(row[0], row[1]);
  for (const auto& row : fix_data(file, run).rows) replay.fixes.emplace_back(row[1], row[2]);
}

void read_truth(const ResultFile& file, std::size_t run, const Scans& frames, Replay& replay) {
  if (!file.has_truth()) return;
  std::vector<double> all(file.times().size() * 3), rows;
  file.read_truth(run, all);
  for (const std::size_t row : file.scan_rows()) {
    rows.insert(rows.end(), {all[3 * row], all[3 * row + 1], all[3 * row + 2]});
  }
  replay.x = component(rows, 0, frames);
  replay.y = component(rows, 1, frames);
  replay.h = component(rows, 2, frames);
}

}  // namespace

Replay read_replay(const ResultFile& file, std::size_t run, const ReplaySize& size) {
  const std::size_t scans = drive_met_by(file, file.runs()[run]).scan_times.size();
  const Scans frames = frame_scans(scans, size.frames);
  Replay replay{file.runs()[run]};
  if (frames.empty()) return replay;
  add_surroundings(file, run, frames, replay);
  read_truth(file, run, frames, replay);
  std::vector<std::size_t> cells;
  for (std::size_t c = 0; c < file.cells().size(); ++c) {
    const StoredCell& cell = file.cells()[c];
    if (!cell.has("pose_mean")) continue;
    if (file.status(cell)[run] != RunStatus::missing) cells.push_back(c);
  }
  for (const std::size_t c : cells) {
    const ReplaySize share = share_of(size, cells.size(), frames.size());
    replay.cells.push_back(read_cell(file, c, run, frames, share));
  }
  return replay;
}

std::vector<ReplayMap> read_maps(const ResultFile& file, const StoredCell& cell, std::size_t run,
                                 std::span<const std::size_t> frame_scans, std::size_t ellipses) {
  const StoredMap stored(file, cell, run);
  if (stored.scans() == 0) return {};
  const std::size_t frames = frame_scans.size();
  if (stored.is_final_only()) return {{frames - 1, stored.at(0)}};
  std::vector<ReplayMap> maps;
  const std::size_t count = std::clamp<std::size_t>(ellipses / stored.landmarks(), 1, frames);
  for (std::size_t k = 1; k <= count; ++k) {
    const std::size_t frame = k * frames / count - 1;
    maps.push_back({frame, stored.at(frame_scans[frame])});
  }
  return maps;
}

}  // namespace montecarta::analysis
