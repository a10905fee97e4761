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

/// Some of a cell's particles at every frame. The ancestors of all shown particles are shown too.
struct ReplayParticles {
  struct Snapshot {
    std::vector<std::uint32_t> shown;  ///< indices of particles, increasing
    /// {particle shown} index of its parent in `shown` of the frame before; empty if no ancestry is
    /// stored, and in the first frame.
    std::vector<std::uint32_t> parent;
    std::vector<double> x, y;  ///< [m] {particle shown} position
    /// Weight divided by the largest of the frame; empty if not stored.
    std::vector<double> weight;
  };
  std::size_t all = 0;  ///< number of particles of the cell
  std::vector<Snapshot> frames;
};

/// The changes of the map at a frame: the landmarks that are new or have changed.
struct ReplayMap {
  struct DrawnLandmark {
    std::uint32_t row = 0;  ///< row of the landmark in the map
    Ellipse ellipse;        ///< ellipse that holds kReplayShare of its probability
  };
  std::size_t frame = 0;
  std::vector<DrawnLandmark> changed;
};

/// The probability that an ellipse of a replay holds.
inline constexpr double kReplayShare = 0.95;

/// The estimate of one cell at every frame. A failed run ends in NaN.
struct ReplayCell {
  std::string label;
  std::size_t style = 0;     ///< style index for line_colour()
  std::string failure = {};  ///< reason why the run failed; empty if it is complete
  std::vector<double> x = {}, y = {}, h = {};  ///< [m], [rad] estimated pose
  std::vector<Ellipse> pose = {};  ///< ellipses that hold kReplayShare; empty if not stored
  std::vector<double> nees = {};   ///< NEES ratio of the leading moments; empty if not known
  Interval nees_band = {};         ///< band that holds kReplayShare of a consistent filter's ratios
  ReplayParticles particles = {};  ///< particles; no frames if not stored
  std::vector<ReplayMap> maps = {};  ///< changes at increasing frames; empty if not stored
  bool has_ancestry = false;
};

/// One run, thinned to be replayed on a page.
struct Replay {
  std::uint64_t run = 0;                                  ///< number of the run in the study
  std::vector<double> times = {};                         ///< [s] {frame} time of each frame
  std::vector<double> x = {}, y = {}, h = {};             ///< [m], [rad] truth; empty if unknown
  std::vector<std::pair<double, double>> landmarks = {};  ///< [m] true positions
  /// [m] positions of the reference of a recorded drive.
  std::vector<std::pair<double, double>> fixes = {};
  std::vector<ReplayCell> cells = {};
  double close_up = 1.0;  ///< [m] half the width of a picture about the vehicle
};

/// The stored data of a cell's particles in one run.
struct StoredParticles {
  std::size_t count = 0;         ///< number of particles
  std::span<const double> pose;  ///< {scan, particle, 3} [m, m, rad] poses
  /// {scan, particle} indices of the parents; empty if not stored.
  std::span<const std::uint32_t> ancestor;
  /// {scan, particle} logarithms of the weights; empty if not stored.
  std::span<const double> log_weight = {};
};

/// Chooses at most `most` particles for each frame; `scans`, increasing, are those of the frames.
/// The last frame shows particles evenly over their indices. Every earlier one shows the parents of
/// those in the next frame and, evenly, as many others as fit.
ReplayParticles thin_particles(const StoredParticles& stored, std::span<const std::size_t> scans,
                               std::size_t most);

/// Limits on the size of a replay, so that a page has some hundred thousand bytes over all cells.
struct ReplaySize {
  std::size_t frames = 300;     ///< largest number of frames
  std::size_t particles = 100;  ///< largest number of particles of a cell in a frame
  /// Largest number of positions of particles, over all cells and frames.
  std::size_t positions = 24'000;
  /// Largest number of ellipses of landmarks, over all cells and frames.
  std::size_t ellipses = 60'000;
};

/// Reads run index `run` of every cell that completed it or failed in it, with frames at equal
/// numbers of scans.
Replay read_replay(const ResultFile& file, std::size_t run, const ReplaySize& size = {});

/// The growth of the map of a cell, at evenly spaced frames, as many as `ellipses` in all allow. A
/// landmark counts as changed if a drawing would show the change. If only the final map is stored,
/// the result is that map at the last frame; if none is stored, it is empty.
std::vector<ReplayMap> read_maps(const ResultFile& file, const StoredCell& cell, std::size_t run,
                                 std::span<const std::size_t> frame_scans, std::size_t ellipses);

/// A run in the form that the page's player reads (page/script/replay.js).
std::string replay_json(const Replay& replay);

/// The replay of the run that chosen_run() chooses; without cells if there is none.
Replay chosen_replay(const ResultFile& file, std::optional<std::uint64_t> run);

/// A section with a player of the replay; empty if it has no cells.
Section replay_section(const ResultFile& file, const Replay& replay);

}  // namespace montecarta::analysis
