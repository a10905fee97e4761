// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/render/figures/path_figure.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/study/section.hpp"
#include "engine/records/result_file.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// Some of a cell's particles at every frame, such that the ancestors of all that are shown are
/// shown too.
struct ReplayParticles {
  struct Snapshot {
    std::vector<std::uint32_t> shown;   ///< indices of particles, increasing
    std::vector<std::uint32_t> parent;  ///< their parents' places in the frame before; empty where
                                        ///< no ancestry is stored, and in the first frame
    std::vector<double> x, y;           ///< [m]
    std::vector<double> weight;         ///< of 1, the heaviest of the frame's; empty: not stored
  };
  std::size_t all = 0;  ///< particles of the cell
  std::vector<Snapshot> frames;
};

/// The changes of the map at a frame: the landmarks that are new or have changed.
struct ReplayMap {
  struct DrawnLandmark {
    std::uint32_t row = 0;  ///< which one it is
    Ellipse ellipse;        ///< kReplayShare of its probability
  };
  std::size_t frame = 0;
  std::vector<DrawnLandmark> changed;
};

/// The probability that an ellipse of a replay holds.
inline constexpr double kReplayShare = 0.95;

/// The estimate of one cell at every frame. A failed run ends in NaN.
struct ReplayCell {
  std::string label;
  std::size_t style = 0;                       ///< for line_colour()
  std::string failure = {};                    ///< why the run failed; empty where it is complete
  std::vector<double> x = {}, y = {}, h = {};  ///< [m], [rad] estimate
  std::vector<Ellipse> pose = {};              ///< kReplayShare of it; empty: not stored
  std::vector<double> nees = {};               ///< by which the verdict is; empty: not known
  Interval nees_band = {};                     ///< kReplayShare of a consistent filter's
  ReplayParticles particles = {};              ///< without frames: not stored
  std::vector<ReplayMap> maps = {};            ///< increasing frames; empty: not stored
  bool has_ancestry = false;
};

/// One run, thinned to be replayed on a page.
struct Replay {
  std::uint64_t run = 0;                                  ///< its number
  std::vector<double> times = {};                         ///< [s] of the frames
  std::vector<double> x = {}, y = {}, h = {};             ///< [m], [rad] truth; empty where unknown
  std::vector<std::pair<double, double>> landmarks = {};  ///< [m] true ones
  std::vector<std::pair<double, double>> fixes = {};      ///< [m] of a recorded drive's reference
  std::vector<ReplayCell> cells = {};
  double close_up = 1.0;  ///< [m] half the width of a picture about the vehicle
};

/// The stored data of a cell's particles in one run.
struct StoredParticles {
  std::size_t count = 0;                    ///< particles
  std::span<const double> pose;             ///< {scan, particle, 3}
  std::span<const std::uint32_t> ancestor;  ///< {scan, particle}; empty: not stored
  std::span<const double> log_weight = {};  ///< likewise
};

/// At most `most` particles a frame; `scans`, increasing, are those of the frames. The last frame
/// shows particles evenly over their indices, every earlier one the parents of the frame behind it
/// and, evenly, as many others as there is room for.
ReplayParticles thin_particles(const StoredParticles& stored, std::span<const std::size_t> scans,
                               std::size_t most);

/// The amount of a run that a page can carry: some hundred thousand bytes over all cells.
struct ReplaySize {
  std::size_t frames = 300;        ///< at most
  std::size_t particles = 100;     ///< of a cell in a frame, at most
  std::size_t positions = 24'000;  ///< of particles, over all cells and frames
  std::size_t ellipses = 60'000;   ///< of landmarks, over all cells and frames
};

/// Reads run index `run` of every cell that completed it or failed in it, thinned in time to equal
/// steps from scan to scan.
Replay read_replay(const ResultFile& file, std::size_t run, const ReplaySize& size = {});

/// The growth of the map of a cell, at as many evenly spaced frames as `ellipses` in all allow. A
/// landmark counts as changed if a drawing would show the change. If only the final map is stored,
/// it is that one at the last frame; if none is stored, it is empty.
std::vector<ReplayMap> read_maps(const ResultFile& file, const StoredCell& cell, std::size_t run,
                                 std::span<const std::size_t> frame_scans, std::size_t ellipses);

/// A run as the page's player reads it (page/script/replay.js).
std::string replay_json(const Replay& replay);

/// The run that chosen_run() chooses; without cells where there is none.
Replay chosen_replay(const ResultFile& file, std::optional<std::uint64_t> run);

/// A player of it; empty where it has no cells.
Section replay_section(const ResultFile& file, const Replay& replay);

}  // namespace montecarta::analysis
