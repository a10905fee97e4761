// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"
#include "filters/factory.hpp"
#include "tests/filters/reference/particle.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace montecarta::filters::reference {

/// A map: by identity where association is known, else by initialisation.
using Landmarks = std::vector<std::optional<Landmark>>;

/// What each detection is, where the simulator tells; a fresh one with the place it will have.
inline std::vector<Pairing> pair_by_identity(Scan scan, const Landmarks& map) {
  std::vector<Pairing> pairings;
  for (const Detection& detection : scan) {
    const auto place = static_cast<std::uint32_t>(detection.identity);
    if (detection.identity == Detection::kClutter) {
      pairings.push_back({});
    } else {
      pairings.push_back({map[place] ? PairingKind::matched : PairingKind::fresh, place, 0.0});
    }
  }
  return pairings;
}

/// Individual-compatibility nearest neighbour (EQUATIONS 17), literally: a map as it looks from a
/// pose of covariance P.
struct NearestNeighbour {
  AssociationSettings settings;
  Eigen::Matrix2d R;
  Eigen::Vector3d pose;
  Eigen::Matrix3d P;  ///< zero where the pose is drawn already

  /// What each detection is.
  std::vector<Pairing> pair(Scan scan, const Landmarks& map) const {
    std::vector<Pairing> pairings;
    for (const Detection& detection : scan) pairings.push_back(nearest(detection, map));
    for (std::uint32_t j = 0; j < map.size(); ++j) keep_one(j, pairings);
    return pairings;
  }

 private:
  Pairing nearest(const Detection& detection, const Landmarks& map) const {
    double least_D2 = std::numeric_limits<double>::infinity();
    Pairing best{.cost = std::numeric_limits<double>::infinity()};
    for (std::uint32_t j = 0; j < map.size(); ++j) {
      const auto seen = seen_from(pose, *map[j], detection, R);
      if (!seen) continue;
      const Eigen::Matrix2d S_z = seen->Hx * P * seen->Hx.transpose() + seen->S_f;
      const double D2 = seen->nu.dot(S_z.inverse() * seen->nu);
      const double ND = D2 + std::log(S_z.determinant());
      least_D2 = std::min(least_D2, D2);
      if (D2 < settings.gate && ND < best.cost) best = {PairingKind::matched, j, ND};
    }
    if (best.kind == PairingKind::matched) return best;
    return {.kind = least_D2 > settings.new_gate ? PairingKind::fresh : PairingKind::ignored};
  }

  /// Of all detections that picked landmark j the one with the least ND keeps it.
  static void keep_one(std::uint32_t j, std::vector<Pairing>& pairings) {
    const auto picked_it = [j](const Pairing& one) {
      return one.kind == PairingKind::matched && one.landmark == j;
    };
    Pairing* winner = nullptr;
    for (Pairing& one : pairings) {
      if (picked_it(one) && (winner == nullptr || one.cost < winner->cost)) winner = &one;
    }
    for (Pairing& one : pairings) {
      if (picked_it(one) && &one != winner) one.kind = PairingKind::ignored;
    }
  }
};

/// log p0 (EQUATIONS 17): log N at D^2 = the gate with S = diag(2 sigma_r^2, 2 sigma_b^2).
inline double log_unmatched(const AssociationSettings& settings, const Belief& belief) {
  const double det_S_ref =
      2.0 * std::pow(belief.sigma_range, 2) * 2.0 * std::pow(belief.sigma_bearing, 2);
  return -0.5 * settings.gate - std::log(kTwoPi) - 0.5 * std::log(det_S_ref) +
         settings.log_new_density_offset;
}

}  // namespace montecarta::filters::reference
