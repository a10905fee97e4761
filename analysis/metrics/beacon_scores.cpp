// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/beacon_scores.hpp"

#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/statistics/means.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

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
