// SPDX-License-Identifier: BSD-3-Clause
#include "filters/association/nearest.hpp"

#include "engine/numbers/angle.hpp"

#include <cmath>

namespace montecarta::filters {

Pairing judge(const NearestSearch& search, const AssociationSettings& settings) {
  if (search.least_cost < std::numeric_limits<double>::infinity()) {
    return {PairingKind::matched, search.landmark, search.least_cost};
  }
  if (search.least_distance > settings.new_gate) return {.kind = PairingKind::fresh};
  return {.kind = PairingKind::ignored};
}

void exclude_rivals(std::span<Pairing> pairings) {
  for (std::size_t later = 1; later < pairings.size(); ++later) {
    if (pairings[later].kind != PairingKind::matched) continue;
    for (std::size_t k = 0; k < later; ++k) {
      Pairing& earlier = pairings[k];
      if (earlier.kind != PairingKind::matched || earlier.landmark != pairings[later].landmark) {
        continue;
      }
      Pairing& loser = pairings[later].cost < earlier.cost ? earlier : pairings[later];
      loser.kind = PairingKind::ignored;
      break;  // at most one earlier detection still held this landmark
    }
  }
}

double log_new_density(const AssociationSettings& settings, const Belief& belief) {
  const auto n = static_cast<double>(components_of(belief.sensor).size());
  const Eigen::Vector2d sigma = deviations_of(belief.sensor, belief);  // 1 beyond n
  const double log_sqrt_det_s = std::log(std::pow(2.0, 0.5 * n) * sigma(0) * sigma(1));
  return -0.5 * settings.gate - 0.5 * n * std::log(kTwoPi) - log_sqrt_det_s +
         settings.log_new_density_offset;
}

}  // namespace montecarta::filters
