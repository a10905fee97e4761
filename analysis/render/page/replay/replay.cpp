// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/page/replay/replay.hpp"

#include "analysis/render/page/html.hpp"
#include "analysis/run/run_metrics.hpp"
#include "analysis/run/run_reader.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/study/figure.hpp"
#include "analysis/study/stored_sums.hpp"
#include "engine/errors.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>

namespace montecarta::analysis {
namespace {

using Scans = std::vector<std::size_t>;

/// Returns {frame} at most `most` scans at equal distances, including the last one.
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

/// The ellipse of two standard deviations enlarged to hold kReplayShare of a Gaussian.
Ellipse grown(Ellipse ellipse) {
  static const double factor = std::sqrt(-2.0 * std::log(1.0 - kReplayShare)) / 2.0;
  ellipse.major *= factor;
  ellipse.minor *= factor;
  return ellipse;
}

std::vector<Ellipse> pose_ellipses_at(const MomentRows& moments, const Scans& frames) {
  std::vector<Ellipse> ellipses;
  if (moments.covariance.empty()) return ellipses;
  for (const std::size_t s : frames) {
    const double* P = moments.covariance.data() + 9 * s;
    ellipses.push_back(
        grown(two_sigma_ellipse(moments.mean[3 * s], moments.mean[3 * s + 1], P[0], P[3], P[4])));
  }
  return ellipses;
}

/// Reads the particles. After the end of a failed run its ancestors are zeros, which is a valid
/// particle.
ReplayParticles read_particles(const StoredCell& cell, const RunRows& rows, const Scans& frames,
                               std::size_t most) {
  if (rows.particle_pose.empty()) return {};
  return thin_particles({cell.particles, rows.particle_pose, rows.ancestor, rows.log_weight},
                        frames, most);
}

/// Reads the NEES ratio of a complete run with known truth.
void read_nees(const RunRows& rows, const StoredCell& cell, std::span<const double> times,
               const Scans& frames, ReplayCell& replay) {
  if (!replay.failure.empty() || rows.truth.empty()) return;
  RunMetrics metrics;
  // The NEES does not depend on the frame.
  metrics.measure(rows, cell.particles, times, ErrorFrame::of_truth);
  const NeesRows* nees = metrics.leading_nees();
  if (nees == nullptr) return;
  const auto dimension = static_cast<double>(nees->dimension.front());
  for (const std::size_t s : frames) replay.nees.push_back(nees->value.front()[s] / dimension);
  const Interval band = nees_bounds(1, nees->dimension.front(), kReplayShare);
  replay.nees_band = {band.lower / dimension, band.upper / dimension};
}

/// Returns the reason why a run failed; empty if it is complete.
std::string failure_of(const ResultFile& file, const StoredCell& cell, std::size_t run) {
  if (file.status(cell)[run] != RunStatus::failed) return "";
  return "failed at step " + std::to_string(file.failure_steps(cell)[run]) + ": " +
         file.failure_reasons(cell)[run];
}

/// Adds one cell, and the truth, which is the same for all of them.
void add_cell(const ResultFile& file, std::size_t index, std::size_t run, const Scans& frames,
              const ReplaySize& size, Replay& whole) {
  const StoredCell& cell = file.cells()[index];
  const RunRows rows = read_run(file, cell, run);
  whole.x = component(rows.truth, 0, frames);
  whole.y = component(rows.truth, 1, frames);
  whole.h = component(rows.truth, 2, frames);
  const MomentRows& moments = estimate_of(rows);
  ReplayCell replay{cell.label, index, failure_of(file, cell, run)};
  replay.x = component(moments.mean, 0, frames);
  replay.y = component(moments.mean, 1, frames);
  replay.h = component(moments.mean, 2, frames);
  replay.pose = pose_ellipses_at(moments, frames);
  read_nees(rows, cell, drive_of_run(file, file.runs()[run]).scan_times, frames, replay);
  replay.particles = read_particles(cell, rows, frames, size.particles);
  replay.has_ancestry = !rows.ancestor.empty();
  replay.maps = read_maps(file, cell, run, frames, size.ellipses);
  whole.cells.push_back(std::move(replay));
}

/// Divides the limits for a whole replay by its number of cells.
ReplaySize share_of(const ReplaySize& size, std::size_t cells, std::size_t frames) {
  ReplaySize share = size;
  share.particles =
      std::min(std::max<std::size_t>(size.positions / (cells * frames), 8), size.particles);
  share.ellipses = size.ellipses / cells;
  return share;
}

void add_surroundings(const ResultFile& file, std::size_t run, const Scans& frames,
                      Replay& replay) {
  const auto times = drive_of_run(file, file.runs()[run]).scan_times;
  for (const std::size_t s : frames) replay.times.push_back(times[s]);
  for (const auto& at : file.landmarks_of(run)) replay.landmarks.emplace_back(at.x(), at.y());
  const Frame fixes = fix_data(file, run).frame;
  for (std::size_t f = 0; f < fixes.rows(); ++f) {
    replay.fixes.emplace_back(fixes.columns[1].numbers[f], fixes.columns[2].numbers[f]);
  }
}

/// [m] The size that the ellipses do not exceed in nine of ten frames, rounded to 1, 2 or 5 times a
/// power of ten.
double close_up_of(const Replay& replay) {
  std::vector<double> reach;
  for (const ReplayCell& cell : replay.cells) {
    for (std::size_t f = 0; f < cell.x.size(); ++f) {
      const double error =
          replay.x.empty() ? 0.0 : std::hypot(cell.x[f] - replay.x[f], cell.y[f] - replay.y[f]);
      reach.push_back(error + (cell.pose.empty() ? 0.0 : 0.5 * cell.pose[f].major));
    }
  }
  std::erase_if(reach, [](double value) { return !std::isfinite(value); });
  if (reach.empty()) return 1.0;
  std::ranges::sort(reach);
  const double wanted = std::clamp(reach[reach.size() * 9 / 10], 0.1, 1e6);
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= wanted) return step * power;
  }
  return 10.0 * power;
}

}  // namespace

Replay read_replay(const ResultFile& file, std::size_t run, const ReplaySize& size) {
  const std::size_t scans = drive_of_run(file, file.runs()[run]).scan_times.size();
  const Scans frames = frame_scans(scans, size.frames);
  Replay replay{file.runs()[run]};
  if (frames.empty()) return replay;
  add_surroundings(file, run, frames, replay);
  std::vector<std::size_t> cells;
  for (std::size_t c = 0; c < file.cells().size(); ++c) {
    const StoredCell& cell = file.cells()[c];
    if (!cell.has("pose_mean")) continue;
    if (engine::is_stored(file.status(cell)[run])) cells.push_back(c);
  }
  for (const std::size_t c : cells) {
    const ReplaySize share = share_of(size, cells.size(), frames.size());
    add_cell(file, c, run, frames, share, replay);
  }
  replay.close_up = close_up_of(replay);
  return replay;
}

namespace {

/// [m] The least change that is visible in a drawing of the whole map: a thousandth of it, half a
/// pixel.
double visible_change(const ResultFile& file, const StoredMap& stored, std::size_t run,
                      std::size_t last_scan) {
  Bounds bounds;
  for (const auto& at : file.landmarks_of(run)) bounds.include(at.x(), at.y());
  if (bounds.empty()) {
    for (const Ellipse& ellipse : stored.at(last_scan)) bounds.include(ellipse.x, ellipse.y);
  }
  if (bounds.empty()) return 0.0;
  return 1e-3 * std::max(bounds.right - bounds.left, bounds.high - bounds.low);
}

bool looks_alike(const Ellipse& a, const Ellipse& b, double least) {
  return std::abs(a.x - b.x) < least && std::abs(a.y - b.y) < least &&
         std::abs(a.major - b.major) < least && std::abs(a.minor - b.minor) < least;
}

/// The changes since `shown`, which is then updated. A landmark that is no longer in the map has an
/// ellipse of NaN.
std::vector<ReplayMap::DrawnLandmark> changes_at(const StoredMap& stored, std::size_t scan,
                                                 double least,
                                                 std::vector<std::optional<Ellipse>>& shown) {
  std::vector<ReplayMap::DrawnLandmark> changed;
  for (std::size_t l = 0; l < shown.size(); ++l) {
    const auto row = static_cast<std::uint32_t>(l);
    const auto ellipse = stored.at(scan, l);
    if (!ellipse) {
      if (shown[l]) changed.push_back({row, {kNaN, kNaN, kNaN, kNaN, kNaN}});
      shown[l].reset();
      continue;
    }
    if (shown[l] && looks_alike(*shown[l], grown(*ellipse), least)) continue;
    shown[l] = grown(*ellipse);
    changed.push_back({row, *shown[l]});
  }
  return changed;
}

}  // namespace

std::vector<ReplayMap> read_maps(const ResultFile& file, const StoredCell& cell, std::size_t run,
                                 std::span<const std::size_t> frame_scans, std::size_t ellipses) {
  const StoredMap stored(file, cell, run);
  if (stored.scans() == 0) return {};
  const std::size_t frames = frame_scans.size();
  std::vector<std::optional<Ellipse>> shown(stored.landmarks());
  if (stored.is_final_only()) return {{frames - 1, changes_at(stored, 0, 0.0, shown)}};
  const double least = visible_change(file, stored, run, frame_scans.back());
  std::vector<ReplayMap> maps;
  const std::size_t count = std::clamp<std::size_t>(ellipses / stored.landmarks(), 1, frames);
  for (std::size_t k = 1; k <= count; ++k) {
    const std::size_t frame = k * frames / count - 1;
    auto changed = changes_at(stored, frame_scans[frame], least, shown);
    if (!changed.empty()) maps.push_back({frame, std::move(changed)});
  }
  return maps;
}

namespace {

using Indices = std::vector<std::uint32_t>;

/// Index, at scan `before`, of the ancestor of particle `i` of scan `scan`.
std::uint32_t ancestor_at(const StoredParticles& stored, std::size_t scan, std::size_t before,
                          std::uint32_t i) {
  for (; scan > before; --scan) i = stored.ancestor[scan * stored.count + i];
  return i;
}

/// Adds particles, evenly over the indices, until there are `most`; the result is sorted.
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

/// Chooses the particles of frame `f - 1`, and links those of frame `f` to them as their parents.
void tie_to_parents(const StoredParticles& stored, std::span<const std::size_t> scans,
                    std::size_t f, std::size_t most, ReplayParticles& particles) {
  ReplayParticles::Snapshot& before = particles.frames[f - 1];
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

/// Weights of the particles that are shown, divided by the largest one.
void add_weights(const StoredParticles& stored, std::size_t scan,
                 ReplayParticles::Snapshot& frame) {
  if (stored.log_weight.empty()) return;
  const auto all = stored.log_weight.subspan(scan * stored.count, stored.count);
  const double heaviest = *std::ranges::max_element(all);
  for (const std::uint32_t i : frame.shown) frame.weight.push_back(std::exp(all[i] - heaviest));
}

}  // namespace

ReplayParticles thin_particles(const StoredParticles& stored, std::span<const std::size_t> scans,
                               std::size_t most) {
  ReplayParticles particles{stored.count, std::vector<ReplayParticles::Snapshot>(scans.size())};
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
    add_weights(stored, scans[f], particles.frames[f]);
  }
  return particles;
}

namespace {

bool has_particles(const ReplayCell& cell) { return !cell.particles.frames.empty(); }

/// Text of the data that the player shows.
std::string shown(const Replay& replay) {
  const auto if_any = [&](const char* key, const auto& has) {
    return std::ranges::any_of(replay.cells, has) ? prose("replay", key) : "";
  };
  return prose(
      "replay", "shown",
      {{"paths", prose("replay", replay.x.empty() ? "estimate" : "truth")},
       {"level", level_text(kReplayShare)},
       {"particles", if_any("particles", has_particles)},
       {"ancestors",
        if_any("ancestors",
               [](const ReplayCell& cell) { return has_particles(cell) && cell.has_ancestry; })},
       {"metres", exact_text(2.0 * replay.close_up)},
       {"nees", if_any("nees", [](const ReplayCell& cell) { return !cell.nees.empty(); })}});
}

/// Text that explains which run of how many is shown, why, and whether more is stored of it than of
/// others.
std::string which_run(const ResultFile& file, const Replay& replay) {
  const std::size_t index = *chosen_run(file, replay.run);
  const std::uint64_t runs = runs_in(file);
  const std::string run = std::to_string(replay.run);
  if (runs == 1) return prose("replay", "only run", {{"run", run}});
  const std::size_t cells = file.cells().size();
  const auto complete = static_cast<std::size_t>(std::ranges::count_if(
      replay.cells, [](const ReplayCell& cell) { return cell.failure.empty(); }));
  const std::string which =
      complete == cells ? "every cell"
                        : std::to_string(complete) + " of " + std::to_string(cells) + " cells";
  const std::string reason = chosen_run(file, {}) != index
                                 ? prose("replay", "chosen")
                                 : prose("replay", "first", {{"cells", which}});
  std::string words = prose("replay", "one run",
                            {{"run", run}, {"runs", std::to_string(runs)}, {"reason", reason}});
  if (index >= file.description().full_runs_here()) return words;
  return words + " " +
         prose("replay", "full runs", {{"runs", std::to_string(file.description().full_runs)}});
}

/// Text of the columns that a user must record to see more; empty if all are there, and for
/// imported estimates.
std::string wanted(const ResultFile& file, std::size_t run) {
  if (file.cells().front().has("error")) return "";
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
  const std::uint64_t full = file.description().full_runs;
  const std::string remedy = full > 0 ? prose("replay", "choose", {{"runs", std::to_string(full)}})
                                      : prose("replay", "store");
  return prose("replay", "wanted",
               {{"columns", more.substr(2)},
                {"remedy", remedy},
                {"file", file.path().filename().string()},
                {"run", std::to_string(file.runs()[run])}});
}

}  // namespace

Replay chosen_replay(const ResultFile& file, std::optional<std::uint64_t> run) {
  const auto index = chosen_run(file, run);
  return index ? read_replay(file, *index) : Replay{};
}

Section replay_section(const ResultFile& file, const Replay& replay) {
  if (replay.cells.empty()) return {};
  Section section{"replay", "What happened in one run?"};
  section.add_html("<p class=\"soft\">" + html_escape(which_run(file, replay)) + "</p>\n");
  section.add_html(
      "<div class=\"player\">\n<noscript><p class=\"soft\">The player needs scripts; its last "
      "moment is drawn in <a href=\"figures/replay.svg\">figures/replay.svg</a>.</p></noscript>\n" +
      html_data("replay-data", replay_json(replay)) + "</div>\n");
  section.add(std::vector{shown(replay)});
  const std::string more = wanted(file, *chosen_run(file, replay.run));
  if (!more.empty()) section.add(std::vector{more});
  return section;
}

namespace {

constexpr int kPlaceDigits = 6;  // a millimetre in 300 m
constexpr int kSizeDigits = 3;
constexpr int kAngleDigits = 2;

Json json_of(const std::vector<std::pair<double, double>>& points) {
  Json array = Json::array();
  for (const auto& [x, y] : points) {
    array.push_back(rounded(x));
    array.push_back(rounded(y));
  }
  return array;
}

/// Adds diameters [m] and angle [deg].
void add_size(const Ellipse& e, Json& array) {
  array.push_back(rounded(e.major, kSizeDigits));
  array.push_back(rounded(e.minor, kSizeDigits));
  array.push_back(rounded(e.angle, kAngleDigits));
}

/// Adds a number >= 0 as digits of base 64, which are a third as long as decimal ones.
void add_digits(double number, int count, std::string& text) {
  constexpr std::string_view kDigits =
      "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz-_";
  auto rest = static_cast<unsigned>(number);
  std::string digits(static_cast<std::size_t>(count), '0');
  for (auto digit = digits.rbegin(); digit != digits.rend(); ++digit, rest /= 64) {
    *digit = kDigits[rest % 64];
  }
  text += digits;
}

/// Adds an offset as two digits: 1 is -`size`, 4095 is +`size`, and 0 is NaN.
void add_place(double offset, double size, std::string& text) {
  const double share = std::round(2047.0 * offset / size);
  add_digits(std::abs(share) <= 2047.0 ? 2048.0 + share : 0.0, 2, text);
}

/// [m] The greatest distance of a particle from the estimate along an axis.
double reach_of(const ReplayParticles::Snapshot& frame, double x, double y) {
  double size = 0.0;
  for (std::size_t i = 0; i < frame.x.size(); ++i) {
    for (const double offset : {std::abs(frame.x[i] - x), std::abs(frame.y[i] - y)}) {
      if (std::isfinite(offset)) size = std::max(size, offset);
    }
  }
  return 1.0001 * size + 1e-9;
}

/// Text of the particles, each with x and y relative to the estimate (four digits), its parent (two
/// digits), and the root of its weight (one digit), which is its opacity.
Json json_of(const ReplayParticles::Snapshot& frame, double x, double y) {
  const double size = reach_of(frame, x, y);
  std::string dots, parents, weights;
  for (std::size_t i = 0; i < frame.x.size(); ++i) {
    add_place(frame.x[i] - x, size, dots);
    add_place(frame.y[i] - y, size, dots);
  }
  for (const std::uint32_t parent : frame.parent) add_digits(parent, 2, parents);
  for (const double weight : frame.weight) {
    add_digits(weight > 0.0 ? std::round(63.0 * std::sqrt(weight)) : 0.0, 1, weights);
  }
  Json json = {{"size", rounded(size)}, {"dots", dots}};
  if (!parents.empty()) json["parent"] = parents;
  if (!weights.empty()) json["weight"] = weights;
  return json;
}

void add_particles(const ReplayCell& cell, Json& json) {
  json["particles"] = cell.particles.all;
  Json& clouds = json["clouds"] = Json::array();
  for (std::size_t f = 0; f < cell.particles.frames.size(); ++f) {
    clouds.push_back(json_of(cell.particles.frames[f], cell.x[f], cell.y[f]));
  }
}

/// Six numbers for each landmark: row, centre [m], diameters [m] and angle [deg].
Json json_of(const ReplayMap& map) {
  Json landmarks = Json::array();
  for (const auto& [row, ellipse] : map.changed) {
    landmarks.push_back(row);
    landmarks.push_back(rounded(ellipse.x));
    landmarks.push_back(rounded(ellipse.y));
    add_size(ellipse, landmarks);
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
  json["nees"] = rounded(cell.nees, kSizeDigits);
  json["band"] = {rounded(cell.nees_band.lower), rounded(cell.nees_band.upper)};
  add_particles(cell, json);
  Json& maps = json["maps"] = Json::array();
  for (const ReplayMap& map : cell.maps) maps.push_back(json_of(map));
  return json;
}

}  // namespace

std::string replay_json(const Replay& replay) {
  Json json = {{"run", replay.run},
               {"close_up", rounded(replay.close_up)},
               {"times", rounded(replay.times, kPlaceDigits)}};
  json["truth"] = Json::object();
  add_path(replay.x, replay.y, replay.h, json["truth"]);
  json["landmarks"] = json_of(replay.landmarks);
  json["fixes"] = json_of(replay.fixes);
  Json& cells = json["cells"] = Json::array();
  for (const ReplayCell& cell : replay.cells) cells.push_back(json_of(cell));
  return script_text(json);
}

}  // namespace montecarta::analysis
