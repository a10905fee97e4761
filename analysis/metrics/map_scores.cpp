// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/map_scores.hpp"

#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/statistics/means.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
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

}  // namespace montecarta::analysis
