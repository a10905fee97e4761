// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/replay/replay.hpp"

#include "analysis/data/run_reader.hpp"
#include "analysis/output/figure.hpp"
#include "analysis/page/html.hpp"
#include "analysis/page/page.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>
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
  if (cell.particles == 0 || !file.holds(cell, "particle_pose", run)) return {};
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

namespace {

using Indices = std::vector<std::uint32_t>;

/// Index at scan `before` of the ancestor of particle `i` of scan `scan`.
std::uint32_t ancestor_at(const StoredParticles& stored, std::size_t scan, std::size_t before,
                          std::uint32_t i) {
  for (; scan > before; --scan) {
    i = stored.ancestor[scan * stored.count + i];
    if (i >= stored.count) throw StudyError("ancestor: no such particle (the file is damaged)");
  }
  return i;
}

/// Adds particles, evenly over the indices, until there are `most`; sorted.
void fill_up(Indices& shown, std::size_t count, std::size_t most) {
  std::ranges::sort(shown);
  shown.erase(std::unique(shown.begin(), shown.end()), shown.end());
  const Indices parents = shown;
  for (std::size_t k = 0; k < most && shown.size() < std::min(most, count); ++k) {
    const auto i = static_cast<std::uint32_t>(count <= most ? k : k * count / most);
    if (!std::ranges::binary_search(parents, i)) shown.push_back(i);
  }
  std::ranges::sort(shown);
}

/// Chooses the particles of frame `f - 1` and ties those of frame `f` to them.
void tie_to_parents(const StoredParticles& stored, std::span<const std::size_t> scans,
                    std::size_t f, std::size_t most, ReplayParticles& particles) {
  ReplayParticles::Frame& before = particles.frames[f - 1];
  Indices parents;
  if (!stored.ancestor.empty()) {
    for (const std::uint32_t i : particles.frames[f].shown) {
      parents.push_back(ancestor_at(stored, scans[f], scans[f - 1], i));
    }
  }
  before.shown = parents;
  fill_up(before.shown, stored.count, most);
  for (const std::uint32_t parent : parents) {
    const auto place = std::ranges::lower_bound(before.shown, parent) - before.shown.begin();
    particles.frames[f].parent.push_back(static_cast<std::uint32_t>(place));
  }
}

}  // namespace

ReplayParticles thin_particles(const StoredParticles& stored, std::span<const std::size_t> scans,
                               std::size_t most) {
  ReplayParticles particles{stored.count, std::vector<ReplayParticles::Frame>(scans.size())};
  if (scans.empty()) return particles;
  fill_up(particles.frames.back().shown, stored.count, most);
  for (std::size_t f = scans.size() - 1; f > 0; --f) {
    tie_to_parents(stored, scans, f, most, particles);
  }
  for (std::size_t f = 0; f < scans.size(); ++f) {
    for (const std::uint32_t i : particles.frames[f].shown) {
      const double* pose = stored.pose.data() + 3 * (scans[f] * stored.count + i);
      particles.frames[f].x.push_back(pose[0]);
      particles.frames[f].y.push_back(pose[1]);
    }
  }
  return particles;
}

namespace {

constexpr int kPlaceDigits = 6;  // a millimetre in 300 m
constexpr int kSizeDigits = 3;

Json json_of(const std::vector<std::pair<double, double>>& points) {
  Json array = Json::array();
  for (const auto& [x, y] : points) {
    array.push_back(rounded(x));
    array.push_back(rounded(y));
  }
  return array;
}

/// Diameters [m] and angle [deg].
void add_size(const Ellipse& e, Json& array) {
  for (const double value : {e.major, e.minor, e.angle}) {
    array.push_back(rounded(value, kSizeDigits));
  }
}

/// Places relative to the estimate in whole units, which are short to write.
Json relative_places(const std::vector<double>& places, double centre, double unit) {
  Json array = Json::array();
  for (const double place : places) {
    const double units = std::round((place - centre) / unit);
    array.push_back(std::abs(units) < 1e9 ? Json(static_cast<int>(units)) : rounded(units, 9));
  }
  return array;
}

/// A power of ten [m], a hundred thousandth of the greatest coordinate or less.
double unit_of(const ReplayCell& cell) {
  double greatest = 1.0;
  for (const auto* values : {&cell.x, &cell.y}) {
    for (const double value : *values) {
      if (std::isfinite(value)) greatest = std::max(greatest, std::abs(value));
    }
  }
  return std::pow(10.0, std::floor(std::log10(greatest)) - 5.0);
}

void add_particles(const ReplayCell& cell, Json& json) {
  const double unit = unit_of(cell);
  json["particles"] = cell.particles.all;
  json["unit"] = rounded(unit);
  Json& clouds = json["clouds"] = Json::array();
  for (std::size_t f = 0; f < cell.particles.frames.size(); ++f) {
    const ReplayParticles::Frame& frame = cell.particles.frames[f];
    Json cloud = {{"x", relative_places(frame.x, cell.x[f], unit)},
                  {"y", relative_places(frame.y, cell.y[f], unit)}};
    if (!frame.parent.empty()) cloud["parent"] = frame.parent;
    clouds.push_back(std::move(cloud));
  }
}

/// Centre [m], diameters [m] and angle [deg], five numbers a landmark.
Json json_of(const ReplayMap& map) {
  Json landmarks = Json::array();
  for (const Ellipse& e : map.landmarks) {
    landmarks.push_back(rounded(e.x));
    landmarks.push_back(rounded(e.y));
    add_size(e, landmarks);
  }
  return {{"frame", map.frame}, {"landmarks", std::move(landmarks)}};
}

void add_path(const std::vector<double>& x, const std::vector<double>& y,
              const std::vector<double>& h, Json& json) {
  json["x"] = rounded(x, kPlaceDigits);
  json["y"] = rounded(y, kPlaceDigits);
  json["h"] = rounded(h, kSizeDigits + 1);
}

Json json_of(const ReplayCell& cell) {
  Json json = {{"label", cell.label},
               {"failure", cell.failure},
               {"colour", line_colour(cell.style)},
               {"ancestry", cell.has_ancestry}};
  add_path(cell.x, cell.y, cell.h, json);
  Json& pose = json["pose"] = Json::array();
  for (const Ellipse& e : cell.pose) add_size(e, pose);
  add_particles(cell, json);
  Json& maps = json["maps"] = Json::array();
  for (const ReplayMap& map : cell.maps) maps.push_back(json_of(map));
  return json;
}

}  // namespace

std::string replay_json(const Replay& replay) {
  Json json = {{"run", replay.run}, {"times", rounded(replay.times, kPlaceDigits)}};
  json["truth"] = Json::object();
  add_path(replay.x, replay.y, replay.h, json["truth"]);
  json["landmarks"] = json_of(replay.landmarks);
  json["fixes"] = json_of(replay.fixes);
  Json& cells = json["cells"] = Json::array();
  for (const ReplayCell& cell : replay.cells) cells.push_back(json_of(cell));
  return script_text(json);
}

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
std::string wanted(const ResultFile& file, std::size_t run) {
  const auto lacks = [&](const char* column, bool of_particles) {
    return std::ranges::any_of(file.cells(), [&](const StoredCell& cell) {
      return !(of_particles && cell.particles == 0) && !file.holds(cell, column, run);
    });
  };
  std::string more;
  if (lacks("pose_covariance", false)) more += ", covariance";
  if (lacks("particle_pose", true)) more += ", particles";
  if (lacks("ancestor", true)) more += ", ancestry";
  if (lacks("map_mean", false)) more += ", map";
  if (more.empty()) return "";
  return "This file does not hold everything of this run that can be replayed (" + more.substr(2) +
         "): give the study record.full_runs = 1 to store all of the first run, or let "
         "montecarta replay " +
         file.path().filename().string() + " --cell CELL --run " +
         std::to_string(file.runs()[run]) + " -o ONE.h5 record it, and report on that file.";
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
  if (const std::string more = wanted(file, *index); !more.empty()) section.add(std::vector{more});
  return section;
}

}  // namespace montecarta::analysis
