// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/figures/ellipse.hpp"

#include <cstddef>
#include <cstdint>
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

}  // namespace montecarta::analysis
