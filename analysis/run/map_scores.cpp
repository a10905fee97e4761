// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/map_scores.hpp"

#include "engine/errors.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

/// State of the assignment. Rows and columns count from 1. The prices keep all distances at least
/// 0.
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

  /// Finds the shortest path from the row, which begins in column 0, to a free column, and moves
  /// the rows on this path along it.
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
  /// {column} row assigned to the column; 0 if the column is free.
  std::vector<std::size_t> row_of;
};

using PointSpan = std::span<const Eigen::Vector2d>;

/// Squared distances, cut to the squared cutoff: such a pair is no better than two landmarks
/// without a partner.
Eigen::MatrixXd costs(PointSpan few, PointSpan many, double cutoff) {
  Eigen::MatrixXd cost(few.size(), many.size());
  for (Eigen::Index i = 0; i < cost.rows(); ++i) {
    for (Eigen::Index j = 0; j < cost.cols(); ++j) {
      const double squared =
          (few[static_cast<std::size_t>(i)] - many[static_cast<std::size_t>(j)]).squaredNorm();
      cost(i, j) = squared < cutoff * cutoff ? squared : cutoff * cutoff;  // NaN becomes the cutoff
    }
  }
  return cost;
}

/// The landmarks that came into view along `path`.
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
  double squares = 0.0, traces = 0.0, nees = 0.0, n = 0.0, n_nees = 0.0;
  for (std::size_t l = 0; l < scores.landmarks.size() && l < map.seen.size(); ++l) {
    if (map.seen[l] == 0) continue;
    const LandmarkScore one = score(map.mean[l] - landmarks[l], map.covariance[l]);
    scores.landmarks[l] = one;
    squares += one.squared_error;
    traces += map.covariance[l].trace();
    n += 1.0;
    if (!std::isfinite(one.nees)) {
      ++scores.undefined;
      continue;
    }
    nees += one.nees;
    n_nees += 1.0;
  }
  if (n > 0.0) {
    scores.rms = std::sqrt(squares / n);
    scores.deviation = std::sqrt(traces / n);
  }
  if (n_nees > 0.0) scores.nees = nees / n_nees;
}

using Points = std::vector<Eigen::Vector2d>;

struct BeaconPair {
  double squared = 0.0;  ///< [m^2] squared distance between landmark and beacon
  std::size_t landmark = 0, beacon = 0;
};

std::vector<BeaconPair> near_pairs(std::span<const Eigen::Vector2d> map,
                                   std::span<const Eigen::Vector2d> beacons,
                                   const RigidMotion& alignment) {
  std::vector<BeaconPair> pairs;
  for (std::size_t b = 0; b < beacons.size(); ++b) {
    for (std::size_t l = 0; l < map.size(); ++l) {
      const double squared = (alignment(map[l]) - beacons[b]).squaredNorm();
      if (squared <= kFoundWithin * kFoundWithin) pairs.push_back({squared, l, b});
    }
  }
  std::ranges::stable_sort(pairs, {}, &BeaconPair::squared);
  return pairs;
}

double rms(const Points& map, const Points& beacons, const RigidMotion& motion) {
  double sum = 0.0;
  for (std::size_t i = 0; i < map.size(); ++i) sum += (motion(map[i]) - beacons[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(map.size()));
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
  for (const BeaconPair& pair : near_pairs(map, beacons, alignment)) {
    if (landmark_taken[pair.landmark] || beacon_found[pair.beacon]) continue;
    landmark_taken[pair.landmark] = beacon_found[pair.beacon] = true;
    estimated.push_back(map[pair.landmark]);
    surveyed.push_back(beacons[pair.beacon]);
  }
  if (estimated.empty()) return {};
  return {static_cast<double>(estimated.size()), rms(estimated, surveyed, {}),
          rms(estimated, surveyed, alignment)};
}

}  // namespace montecarta::analysis
