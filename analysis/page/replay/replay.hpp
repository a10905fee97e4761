// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/figures/path_figure.hpp"
#include "engine/records/result_file.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// Some of a cell's particles at every frame, such that the ancestors of all that are shown are
/// shown too.
struct ReplayParticles {
  struct Frame {
    std::vector<std::uint32_t> shown;   ///< indices of particles, increasing
    std::vector<std::uint32_t> parent;  ///< their parents' places in the frame before; empty where
                                        ///< no ancestry is stored, and in the first frame
    std::vector<double> x, y;           ///< [m]
  };
  std::size_t all = 0;  ///< particles of the cell
  std::vector<Frame> frames;
};

/// Landmarks that the filter has, as ellipses of two standard deviations.
struct ReplayMap {
  std::size_t frame = 0;  ///< from which it holds
  std::vector<Ellipse> landmarks;
};

/// What one cell thought at every frame. A failed run ends in NaN.
struct ReplayCell {
  std::string label;
  std::size_t style = 0;                       ///< for line_colour()
  std::string failure = {};                    ///< why the run failed; empty where it is complete
  std::vector<double> x = {}, y = {}, h = {};  ///< [m], [rad] estimate
  std::vector<Ellipse> pose = {};              ///< two standard deviations; empty: not stored
  ReplayParticles particles = {};              ///< without frames: not stored
  std::vector<ReplayMap> maps = {};            ///< by frame; empty: not stored
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
};

/// What is stored of a cell's particles in one run.
struct StoredParticles {
  std::size_t count = 0;                    ///< particles
  std::span<const double> pose;             ///< {scan, particle, 3}
  std::span<const std::uint32_t> ancestor;  ///< {scan, particle}; empty: not stored
};

/// At most `most` particles a frame; `scans`, increasing, are those of the frames. The last frame
/// shows particles evenly over their indices, every earlier one the parents of the frame behind it
/// and, evenly, as many others as there is room for.
ReplayParticles thin_particles(const StoredParticles& stored, std::span<const std::size_t> scans,
                               std::size_t most);

/// How much of a run a page can carry: some megabytes over all cells.
struct ReplaySize {
  std::size_t frames = 400;         ///< at most
  std::size_t particles = 100;      ///< of a cell in a frame, at most
  std::size_t positions = 300'000;  ///< of particles, over all cells and frames
  std::size_t ellipses = 30'000;    ///< of landmarks, over all cells and frames
};

/// Reads run index `run` of every cell that completed it or failed in it, thinned in time to equal
/// steps from scan to scan.
Replay read_replay(const ResultFile& file, std::size_t run, const ReplaySize& size = {});

/// The landmarks a cell had, at as many of the frames, evenly, as `ellipses` in all allow; where
/// only the final map is stored that one, at the last frame; else nothing.
std::vector<ReplayMap> read_maps(const ResultFile& file, const StoredCell& cell, std::size_t run,
                                 std::span<const std::size_t> frame_scans, std::size_t ellipses);

/// A run as the page's player reads it (page/script/replay.js).
std::string replay_json(const Replay& replay);

}  // namespace montecarta::analysis
