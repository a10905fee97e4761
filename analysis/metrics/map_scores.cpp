// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/map_scores.hpp"

#include <Eigen/Cholesky>

#include <cmath>

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

}  // namespace

MapScores map_scores(const FinalMap& map, const MapCriteria& criteria,
                     std::span<const Eigen::Vector2d> landmarks, std::span<const double> path) {
  MapScores scores;
  scores.gospa = gospa(map.places(), seen_along(path, criteria, landmarks));
  if (criteria.identities_known) score_by_identity(map, landmarks, scores);
  return scores;
}

}  // namespace montecarta::analysis
