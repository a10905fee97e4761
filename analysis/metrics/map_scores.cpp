// SPDX-License-Identifier: BSD-3-Clause
// Landmarks in the map, and the surveyed ones among them.
#include "analysis/metrics/map_scores.hpp"

#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/errors.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

constexpr Eigen::Index kUnassigned = -1;
constexpr double kUnreached = std::numeric_limits<double>::infinity();

/// Dual variables of rows and columns. Their sums never exceed the cost of a pair and equal it for
/// every assigned pair, which makes the assignment optimal.
struct Assignment {
  explicit Assignment(const Eigen::MatrixXd& costs)
      : cost(&costs),
        row_price(costs.rowwise().minCoeff()),
        column_price(Eigen::VectorXd::Zero(costs.cols())),
        column_of(static_cast<std::size_t>(costs.rows()), kUnassigned),
        row_of(static_cast<std::size_t>(costs.cols()), kUnassigned) {}

  double excess(Eigen::Index row, Eigen::Index column) const {
    return (*cost)(row, column) - row_price(row) - column_price(column);
  }
  void assign(Eigen::Index row, Eigen::Index column) {
    column_of[static_cast<std::size_t>(row)] = column;
    row_of[static_cast<std::size_t>(column)] = row;
  }
  Eigen::Index owner(Eigen::Index column) const { return row_of[static_cast<std::size_t>(column)]; }

  const Eigen::MatrixXd* cost;
  Eigen::VectorXd row_price, column_price;
  std::vector<Eigen::Index> column_of, row_of;
};

/// Assigns to every row its cheapest column if that is free.
void assign_cheapest(Assignment& assignment) {
  for (Eigen::Index row = 0; row < assignment.cost->rows(); ++row) {
    Eigen::Index column = 0;
    assignment.cost->row(row).minCoeff(&column);
    if (assignment.owner(column) == kUnassigned) assignment.assign(row, column);
  }
}

/// The cheapest ways from one row to all columns (Dijkstra), until one ends at a free column.
struct Search {
  Search(const Assignment& assignment, Eigen::Index start)
      : distance(static_cast<std::size_t>(assignment.cost->cols()), kUnreached),
        previous(distance.size(), kUnassigned),
        done(distance.size(), false) {
    Eigen::Index row = start, last = kUnassigned;
    double so_far = 0.0;
    while (row != kUnassigned) {
      relax(assignment, row, last, so_far);
      last = nearest();
      so_far = distance[static_cast<std::size_t>(last)];
      done[static_cast<std::size_t>(last)] = true;
      row = assignment.owner(last);
    }
    end = last;
    length = so_far;
  }

  void relax(const Assignment& assignment, Eigen::Index row, Eigen::Index from, double so_far) {
    for (std::size_t c = 0; c < distance.size(); ++c) {
      if (done[c]) continue;
      const double way = so_far + assignment.excess(row, static_cast<Eigen::Index>(c));
      if (way >= distance[c]) continue;
      distance[c] = way;
      previous[c] = from;
    }
  }
  Eigen::Index nearest() const {
    std::size_t best = distance.size();
    for (std::size_t c = 0; c < distance.size(); ++c) {
      if (!done[c] && (best == distance.size() || distance[c] < distance[best])) best = c;
    }
    return static_cast<Eigen::Index>(best);
  }

  std::vector<double> distance;
  std::vector<Eigen::Index> previous;  ///< column before on the way; kUnassigned: the start
  std::vector<bool> done;
  Eigen::Index end = kUnassigned;
  double length = 0.0;
};

/// Gives `start` a column by moving the rows on the cheapest way along it.
void augment(Assignment& assignment, Eigen::Index start) {
  const Search search(assignment, start);
  assignment.row_price(start) += search.length;
  for (std::size_t c = 0; c < search.done.size(); ++c) {
    const auto column = static_cast<Eigen::Index>(c);
    if (!search.done[c] || column == search.end) continue;
    const double shorter = search.length - search.distance[c];
    assignment.column_price(column) -= shorter;
    assignment.row_price(assignment.owner(column)) += shorter;
  }
  Eigen::Index column = search.end;
  for (Eigen::Index before; column != kUnassigned; column = before) {
    before = search.previous[static_cast<std::size_t>(column)];
    assignment.assign(before == kUnassigned ? start : assignment.owner(before), column);
  }
}

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

}  // namespace

std::vector<std::size_t> cheapest_assignment(const Eigen::MatrixXd& cost) {
  expect(cost.rows() <= cost.cols() && cost.allFinite(), "costs are finite, wide as high");
  if (cost.rows() == 0) return {};
  Assignment assignment(cost);
  assign_cheapest(assignment);
  for (Eigen::Index row = 0; row < cost.rows(); ++row) {
    if (assignment.column_of[static_cast<std::size_t>(row)] == kUnassigned)
      augment(assignment, row);
  }
  return {assignment.column_of.begin(), assignment.column_of.end()};
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

namespace {

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
  LandmarkScore score{error.squaredNorm(), std::numeric_limits<double>::quiet_NaN(), true};
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

}  // namespace

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

namespace {

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

}  // namespace

Metric map_size_metric() { return {.scan_series = kMapSize}; }

Metric beacons_metric() { return {.scores = kBeaconsScores, .scores_are_numbers = false}; }

}  // namespace montecarta::analysis
