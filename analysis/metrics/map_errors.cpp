// SPDX-License-Identifier: BSD-3-Clause
// Landmarks in the map, the surveyed ones among them, and how far they are from the truth.
#include "analysis/metrics/map_errors.hpp"

#include "analysis/metrics/cell_report.hpp"
#include "analysis/metrics/cramer_rao.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/errors.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

namespace montecarta::analysis {
namespace {

/// Rows and columns count from 1. Prices keep all distances positive.
struct Assignment {
  explicit Assignment(const Eigen::MatrixXd& costs)
      : cost(costs),
        row_price(static_cast<std::size_t>(costs.rows()) + 1),
        column_price(static_cast<std::size_t>(costs.cols()) + 1),
        row_of(column_price.size()) {}

  double distance_of(std::size_t row, std::size_t column) const {
    return cost(static_cast<Eigen::Index>(row - 1), static_cast<Eigen::Index>(column - 1)) -
           row_price[row] - column_price[column];
  }

  /// Takes the shortest way from the row, which begins in column 0, to a free column, and moves the
  /// rows on this way along it.
  void add(std::size_t row) {
    std::vector<double> distance(row_of.size(), std::numeric_limits<double>::infinity());
    std::vector<std::size_t> before(row_of.size());
    std::vector<bool> is_done(row_of.size());
    std::size_t here = 0;
    row_of[0] = row;
    do {
      is_done[here] = true;
      std::size_t nearest = 0;
      for (std::size_t c = 1; c < row_of.size(); ++c) {
        if (is_done[c]) continue;
        const double way = distance_of(row_of[here], c);
        if (way < distance[c]) before[c] = here;
        distance[c] = std::min(distance[c], way);
        if (nearest == 0 || distance[c] < distance[nearest]) nearest = c;
      }
      const double step = distance[nearest];
      for (std::size_t c = 0; c < row_of.size(); ++c) {
        if (is_done[c]) row_price[row_of[c]] += step;
        (is_done[c] ? column_price : distance)[c] -= step;
      }
      here = nearest;
    } while (row_of[here] != 0);
    for (; here != 0; here = before[here]) row_of[here] = row_of[before[here]];
  }

  const Eigen::MatrixXd& cost;
  std::vector<double> row_price, column_price;
  std::vector<std::size_t> row_of;  ///< {column} 0: free
};

using PointSpan = std::span<const Eigen::Vector2d>;

/// Squared distances, at most the cutoff's: no worse than to leave both alone.
Eigen::MatrixXd costs(PointSpan few, PointSpan many, double cutoff) {
  Eigen::MatrixXd cost(few.size(), many.size());
  for (Eigen::Index i = 0; i < cost.rows(); ++i) {
    for (Eigen::Index j = 0; j < cost.cols(); ++j) {
      const double squared =
          (few[static_cast<std::size_t>(i)] - many[static_cast<std::size_t>(j)]).squaredNorm();
      cost(i, j) = squared < cutoff * cutoff ? squared : cutoff * cutoff;  // NaN is far
    }
  }
  return cost;
}

/// The landmarks that came into view on the way.
std::vector<Eigen::Vector2d> seen_along(std::span<const double> path, const MapCriteria& criteria,
                                        std::span<const Eigen::Vector2d> landmarks) {
  if (!criteria.view) return {landmarks.begin(), landmarks.end()};
  std::vector<bool> seen(landmarks.size());
  for (std::size_t s = 0; s + 2 < path.size(); s += 3) {
    criteria.view->look({path[s], path[s + 1], path[s + 2]}, landmarks,
                        [&](const InView& one) { seen[one.landmark] = true; });
  }
  std::vector<Eigen::Vector2d> found;
  for (std::size_t l = 0; l < seen.size(); ++l) {
    if (seen[l]) found.push_back(landmarks[l]);
  }
  return found;
}

LandmarkScore score(const Eigen::Vector2d& error, const Eigen::Matrix2d& covariance) {
  LandmarkScore score{error.squaredNorm(), kNaN, true};
  const Eigen::LLT<Eigen::Matrix2d> factor(covariance);
  const bool usable = factor.info() == Eigen::Success && covariance.allFinite();
  if (usable) score.nees = factor.matrixL().solve(error).squaredNorm();
  return score;
}

void score_by_identity(const FinalMap& map, std::span<const Eigen::Vector2d> landmarks,
                       MapScores& scores) {
  scores.landmarks.resize(landmarks.size());
  double squares = 0.0, nees = 0.0, n = 0.0, n_nees = 0.0;
  for (std::size_t l = 0; l < scores.landmarks.size() && l < map.seen.size(); ++l) {
    if (map.seen[l] == 0) continue;
    const LandmarkScore one = score(map.mean[l] - landmarks[l], map.covariance[l]);
    scores.landmarks[l] = one;
    squares += one.squared_error;
    n += 1.0;
    if (!std::isfinite(one.nees)) {
      ++scores.undefined;
      continue;
    }
    nees += one.nees;
    n_nees += 1.0;
  }
  if (n > 0.0) scores.rms = std::sqrt(squares / n);
  if (n_nees > 0.0) scores.nees = nees / n_nees;
}

using Points = std::vector<Eigen::Vector2d>;

struct Pair {
  double squared = 0.0;  ///< [m^2]
  std::size_t landmark = 0, beacon = 0;
};

std::vector<Pair> near_pairs(std::span<const Eigen::Vector2d> map,
                             std::span<const Eigen::Vector2d> beacons,
                             const RigidMotion& alignment) {
  std::vector<Pair> pairs;
  for (std::size_t b = 0; b < beacons.size(); ++b) {
    for (std::size_t l = 0; l < map.size(); ++l) {
      const double squared = (alignment(map[l]) - beacons[b]).squaredNorm();
      if (squared <= kFoundWithin * kFoundWithin) pairs.push_back({squared, l, b});
    }
  }
  std::ranges::stable_sort(pairs, {}, &Pair::squared);
  return pairs;
}

double rms(const Points& map, const Points& beacons, const RigidMotion& motion) {
  double sum = 0.0;
  for (std::size_t i = 0; i < map.size(); ++i) sum += (motion(map[i]) - beacons[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(map.size()));
}

template <double BeaconScores::*kValue>
double of_beacons(const MeasuredRun& run) {
  return run.beacons ? (*run.beacons).*kValue : kNaN;
}

double landmarks_in_map(const MeasuredRun& run) {
  const RunRows& rows = run.rows;
  if (!rows.map_size.empty()) return rows.map_size.back();
  return rows.final_map ? static_cast<double>(rows.final_map->places().size()) : kNaN;
}

constexpr Score kBeaconsScores[] = {
    {"map_landmarks", "1", "landmarks in the final map", landmarks_in_map, Better::neither},
    {"beacons_found", "1", "surveyed beacons found", of_beacons<&BeaconScores::found>,
     Better::higher},
    {"beacon_rms", "m", "RMS error of the beacons found", of_beacons<&BeaconScores::rms>},
    {"beacon_aligned_rms", "m", "RMS error of the beacons found, aligned",
     of_beacons<&BeaconScores::aligned_rms>},
};

constexpr ScanSeries kMapSize[] = {{"map_landmarks", "1", [](const MeasuredRun& run) {
                                      return run.rows.truth.empty() ? run.rows.map_size
                                                                    : std::vector<double>();
                                    }}};

template <double MapScores::*kValue>
double of_map(const MeasuredRun& run) {
  return run.map ? (*run.map).*kValue : kNaN;
}
template <double Gospa::*kValue>
double of_map(const MeasuredRun& run) {
  return run.map ? run.map->gospa.*kValue : kNaN;
}

constexpr Score kMapScores[] = {
    {"landmark_rms", "m", "RMS error of the landmarks in the final map", of_map<&MapScores::rms>},
    {"landmark_nees", "1", "NEES of a landmark in the final map, mean over landmarks",
     of_map<&MapScores::nees>},
    {"gospa", "m", "GOSPA of the final map", of_map<&Gospa::distance>},
    {"gospa_localisation", "m", "localisation part of GOSPA", of_map<&Gospa::localisation>},
    {"landmarks_missed", "1", "landmarks missed by the final map", of_map<&Gospa::missed>},
    {"landmarks_spurious", "1", "spurious landmarks of the final map", of_map<&Gospa::spurious>},
};

class MapOverRuns final : public MergedSums<MapOverRuns> {
 public:
  explicit MapOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override { map_.add(run.map); }
  void put(CellAnalysis& cell) override {
    cell.findings.put(map_.result(criteria_->level, criteria_->map.known));
  }
  static constexpr auto parts() { return std::tuple(added(&MapOverRuns::map_)); }

 private:
  const RunCriteria* criteria_;
  MapErrorSums map_;
};

void map_numbers(const CellAnalysis& cell, Frame::Row& all) {
  all.emplace_back("landmarks_undefined", "1",
                   static_cast<double>(cell.get<MapErrors>().undefined));
}

std::vector<TextTable::Entry> map_error_row(const CellAnalysis& cell) {
  const auto text = [&](const char* score) {
    const Summary summary = cell.over_runs(score);
    return with_error(summary.mean, summary.standard_error());
  };
  return {{"landmark RMSE [m]", text("landmark_rms")},
          {"efficiency", percent(cell.get<Efficiency>().map)},
          {"landmark NEES", text("landmark_nees")},
          {"landmarks inside", percent(cell.get<MapErrors>().share_inside())},
          {"GOSPA [m]", text("gospa")},
          {"of it errors [m]", text("gospa_localisation")},
          {"missed", text("landmarks_missed")},
          {"spurious", text("landmarks_spurious")}};
}

/// Reason, and the labels of the cells it is true of: "a, b".
std::map<std::string, std::string> cells_without_map_errors(const StudyAnalysis& study) {
  std::map<std::string, std::string> cells;
  for (const CellAnalysis& cell : study.cells) {
    if (cell.get<MapErrors>().missing.empty()) continue;
    std::string& labels = cells[cell.get<MapErrors>().missing];
    labels += (labels.empty() ? "" : ", ") + cell.label;
  }
  return cells;
}

/// Whether any cell of a simulation has final maps to judge.
bool has_map_errors(const StudyAnalysis& study) {
  return std::ranges::any_of(
      study.cells, [](const CellAnalysis& cell) { return cell.get<MapErrors>().missing.empty(); });
}

/// Adds how to read the table, or why there are no numbers.
void add_map_notes(const StudyAnalysis& study, Section& section) {
  if (has_map_errors(study)) {
    section.add_notes("notes", {{"level", level_text(study.level)},
                                {"penalty", readable(0.5 * kGospaCutoff * kGospaCutoff)},
                                {"cutoff", readable(kGospaCutoff, 1)}});
  }
  if (study.has_truth && study.beacons > 0) {
    for (const auto& [reason, cells] : cells_without_map_errors(study)) {
      section.add_notes("missing", {{"cells", cells}, {"reason", reason}});
    }
  }
  for (const CellAnalysis& cell : study.cells) {
    const std::uint64_t undefined = cell.get<MapErrors>().undefined;
    if (undefined == 0) continue;
    section.add_notes("undefined",
                      {{"cell", cell.label}, {"landmarks", std::to_string(undefined)}});
  }
}

/// One row for each cell and landmark: error and NEES over runs, with the bounds of that NEES.
Frame landmarks_frame(const StudyAnalysis& study) {
  Frame frame;
  for (const CellAnalysis& cell : study.cells) {
    const std::vector<LandmarkErrors>& landmarks = cell.get<MapErrors>().landmarks;
    for (std::size_t l = 0; l < landmarks.size(); ++l) {
      const LandmarkErrors& one = landmarks[l];
      frame.add({{"cell", cell.label},
                 {"landmark", std::to_string(l)},
                 {"runs", "1", static_cast<double>(one.runs)},
                 {"runs_with_nees", "1", static_cast<double>(one.valid)},
                 {"rms", "m", one.rms},
                 {"anees", "1", one.anees},
                 {"lower", "1", one.bounds.lower},
                 {"upper", "1", one.bounds.upper}});
    }
  }
  return frame;
}

/// Range of the landmark errors or, with unknown identities, of GOSPA.
std::string map_summary(const StudyAnalysis& study) {
  const NumberText metres = [](double value) { return readable(value) + " m"; };
  const auto range_of = [&](const char* score) {
    return range_over_cells(
        study, [&](const CellAnalysis& cell) { return cell.known_over_runs(score).summary.mean; },
        metres);
  };
  const std::string rms = range_of("landmark_rms");
  return rms == "-" ? "GOSPA " + range_of("gospa") : "landmark RMSE " + rms;
}

std::vector<Section> map_sections(const StudyAnalysis& study) {
  Section section = section_of("map_errors");
  if (has_map_errors(study)) section.add("map_errors", cell_table(study, map_error_row));
  add_map_notes(study, section);
  if (section.blocks.empty()) return {};
  section.summary = map_summary(study);
  return {section};
}

}  // namespace

std::vector<std::size_t> cheapest_assignment(const Eigen::MatrixXd& cost) {
  expect(cost.rows() <= cost.cols() && cost.allFinite(), "costs are finite, wide as high");
  const auto rows = static_cast<std::size_t>(cost.rows());
  Assignment found(cost);
  for (std::size_t row = 1; row <= rows; ++row) found.add(row);
  std::vector<std::size_t> column_of(rows);
  for (std::size_t c = 1; c < found.row_of.size(); ++c) {
    if (found.row_of[c] != 0) column_of[found.row_of[c] - 1] = c - 1;
  }
  return column_of;
}

Gospa gospa(PointSpan map, PointSpan truth, double cutoff) {
  const bool smaller = map.size() <= truth.size();
  const Eigen::MatrixXd cost = smaller ? costs(map, truth, cutoff) : costs(truth, map, cutoff);
  const std::vector<std::size_t> partner = cheapest_assignment(cost);
  const double far = cutoff * cutoff;
  double squares = 0.0, pairs = 0.0;
  for (std::size_t i = 0; i < partner.size(); ++i) {
    const double squared =
        cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(partner[i]));
    if (squared >= far) continue;
    squares += squared;
    pairs += 1.0;
  }
  Gospa result;
  result.localisation = std::sqrt(squares);
  result.missed = static_cast<double>(truth.size()) - pairs;
  result.spurious = static_cast<double>(map.size()) - pairs;
  result.distance = std::sqrt(squares + 0.5 * far * (result.missed + result.spurious));
  return result;
}

MapScores map_scores(const FinalMap& map, const MapCriteria& criteria,
                     std::span<const Eigen::Vector2d> landmarks, std::span<const double> path) {
  MapScores scores;
  scores.gospa = gospa(map.places(), seen_along(path, criteria, landmarks));
  if (criteria.identities_known) score_by_identity(map, landmarks, scores);
  return scores;
}

BeaconScores beacon_scores(std::span<const Eigen::Vector2d> map,
                           std::span<const Eigen::Vector2d> beacons, const RigidMotion& alignment) {
  std::vector<bool> landmark_taken(map.size()), beacon_found(beacons.size());
  Points estimated, surveyed;
  for (const Pair& pair : near_pairs(map, beacons, alignment)) {
    if (landmark_taken[pair.landmark] || beacon_found[pair.beacon]) continue;
    landmark_taken[pair.landmark] = beacon_found[pair.beacon] = true;
    estimated.push_back(map[pair.landmark]);
    surveyed.push_back(beacons[pair.beacon]);
  }
  if (estimated.empty()) return {};
  return {static_cast<double>(estimated.size()), rms(estimated, surveyed, {}),
          rms(estimated, surveyed, alignment)};
}

Metric map_size_metric() { return {.scan_series = kMapSize}; }

Metric beacons_metric() { return {.scores = kBeaconsScores, .scores_are_numbers = false}; }

double MapErrors::share_inside() const {
  double inside = 0.0, tested = 0.0;
  for (const LandmarkErrors& one : landmarks) {
    if (one.valid == 0) continue;
    tested += 1.0;
    inside += one.anees >= one.bounds.lower && one.anees <= one.bounds.upper ? 1.0 : 0.0;
  }
  return inside / tested;
}

void MapErrorSums::add(const std::optional<MapScores>& run) {
  ++n_runs_;
  if (!run) return;
  ++n_maps_;
  undefined_ += run->undefined;
  landmarks_.resize(run->landmarks.size());
  for (std::size_t l = 0; l < landmarks_.size(); ++l) {
    const LandmarkScore& score = run->landmarks[l];
    if (!score.in_map) continue;
    Sums& sums = landmarks_[l];
    sums.squares += score.squared_error;
    ++sums.runs;
    if (!std::isfinite(score.nees)) continue;
    sums.nees += score.nees;
    ++sums.valid;
  }
}

std::string MapErrorSums::reason(bool known) const {
  if (!known) return "nobody knows where the landmarks are";
  if (n_runs_ == 0) return "no run is complete";
  if (n_maps_ == 0) {
    return "maps are not stored, or not whole: add final_map to record.columns (and enlarge "
           "record.map_rows where it is given)";
  }
  if (n_maps_ < n_runs_) {
    return "the maps of " + std::to_string(n_runs_ - n_maps_) +
           " runs are not whole: enlarge record.map_rows";
  }
  return {};
}

MapErrors MapErrorSums::result(double level, bool known) const {
  MapErrors errors;
  errors.missing = reason(known);
  if (!errors.missing.empty()) return errors;
  if (landmarks_.empty()) return errors;
  errors.undefined = undefined_;
  for (const Sums& sums : landmarks_) {
    LandmarkErrors one{.runs = sums.runs, .valid = sums.valid};
    if (sums.runs > 0) one.rms = std::sqrt(sums.squares / sums.runs);
    if (sums.valid > 0) {
      one.anees = sums.nees / sums.valid;
      one.bounds = nees_bounds(sums.valid, 2, level);
    }
    errors.landmarks.push_back(one);
  }
  return errors;
}

Metric map_metric() {
  return {.scores = kMapScores,
          .sums = make_sums<MapOverRuns>,
          .add_numbers = map_numbers,
          .sections = map_sections,
          .files = {{"landmarks.csv", landmarks_frame}}};
}

}  // namespace montecarta::analysis
