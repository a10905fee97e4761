// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/path_data.hpp"
#include "analysis/page/html.hpp"
#include "analysis/page/page.hpp"
#include "analysis/page/replay/replay.hpp"

#include <algorithm>

namespace montecarta::analysis {
namespace {

/// Whether any of these cells has what `has` looks for.
template <class Has>
bool any(const Replay& replay, Has has) {
  return std::ranges::any_of(replay.cells, has);
}

bool has_particles(const ReplayCell& cell) { return !cell.particles.frames.empty(); }

/// What the player shows of this file.
std::string shown(const Replay& replay) {
  std::string words = "Run " + std::to_string(replay.run) + ", cell by cell: the " +
                      (replay.x.empty() ? "" : "vehicle in grey and the ") +
                      "estimate in colour, with the paths they came along";
  if (any(replay, [](const ReplayCell& cell) { return !cell.pose.empty(); })) {
    words += "; the ellipse holds two standard deviations of the position";
  }
  if (any(replay, has_particles)) words += "; dots are particles";
  if (any(replay,
          [](const ReplayCell& cell) { return has_particles(cell) && cell.has_ancestry; })) {
    words +=
        ", and the threads behind them the ways their ancestors came: where all threads run "
        "together, the particles share one past and cannot doubt it";
  }
  return words + ". Where the filter is consistent, the vehicle is seldom outside of the ellipse.";
}

/// What to record to see more; empty where all is there.
std::string wanted(const ResultFile& file, const Replay& replay) {
  const auto lacks = [&](const char* column, bool of_particles) {
    return std::ranges::any_of(file.cells(), [&](const StoredCell& cell) {
      return !(of_particles && cell.particles == 0) && !cell.has(column);
    });
  };
  std::string more;
  if (lacks("pose_covariance", false)) more += ", covariance";
  if (lacks("particle_pose", true)) more += ", particles";
  if (lacks("ancestor", true)) more += ", ancestry";
  if (lacks("map_mean", false)) more += ", map";
  if (more.empty()) return "";
  return "This file does not hold everything that can be replayed: add '" + more.substr(2) +
         "' to record.columns of the study, or let montecarta replay " +
         file.path().filename().string() + " --cell CELL --run " + std::to_string(replay.run) +
         " -o ONE.h5 record all of one run, and report on that file.";
}

}  // namespace

Section replay_section(const ResultFile& file, std::optional<std::uint64_t> run) {
  const auto index = chosen_run(file, run);
  if (!index) return {};
  const Replay replay = read_replay(file, *index);
  if (replay.cells.empty()) return {};
  Section section{"replay", "What happened in one run?"};
  section.add_html(
      "<div class=\"player\">\n<noscript><p class=\"soft\">The player needs scripts; the "
      "paths below show the same run.</p></noscript>\n" +
      html_data("replay-data", replay_json(replay)) + "</div>\n");
  section.add(std::vector{shown(replay)});
  if (const std::string more = wanted(file, replay); !more.empty()) section.add(std::vector{more});
  return section;
}

}  // namespace montecarta::analysis
