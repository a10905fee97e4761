// SPDX-License-Identifier: BSD-3-Clause
#include "filters/association/pairing.hpp"

#include <cmath>

namespace montecarta::filters {
namespace {

/// The count to which one detection belongs; nullptr if clutter was correctly ignored, or if the
/// identity is not known.
double* count_of(std::int32_t identity, const Pairing& pairing,
                 std::span<const std::int32_t> made_of, AssociationCounts& counts) {
  if (identity == Detection::kUnidentified) return nullptr;
  const bool left_out = pairing.kind == PairingKind::ignored;
  if (identity == Detection::kClutter) return left_out ? nullptr : &counts.clutter;
  if (left_out) return &counts.missed;
  if (pairing.kind == PairingKind::matched) {
    return made_of[pairing.landmark] == identity ? &counts.correct : &counts.wrong;
  }
  const bool held = std::ranges::find(made_of, identity) != made_of.end();
  return held ? &counts.new_again : &counts.correct;
}

}  // namespace

Pairing decide_pairing(const NearestSearch& search, const AssociationSettings& settings) {
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
  // The deviation of a component that the sensor does not have is 1.
  const Eigen::Vector2d sigma = deviations_of(belief.sensor, belief);
  const double log_sqrt_det_s = std::log(std::pow(2.0, 0.5 * n) * sigma(0) * sigma(1));
  return -0.5 * settings.gate - 0.5 * n * std::log(kTwoPi) - log_sqrt_det_s +
         settings.log_new_density_offset;
}

AssociationCounts association_counts(Scan scan, std::span<const Pairing> pairings,
                                     std::span<const std::int32_t> made_of) {
  AssociationCounts counts;
  for (std::size_t k = 0; k < scan.size(); ++k) {
    double* const count = count_of(scan[k].identity, pairings[k], made_of, counts);
    if (count != nullptr) *count += 1.0;
  }
  return counts;
}

void add(const AssociationCounts& counts, double share, AssociationCounts& sum) {
  sum.correct += share * counts.correct;
  sum.wrong += share * counts.wrong;
  sum.new_again += share * counts.new_again;
  sum.missed += share * counts.missed;
  sum.clutter += share * counts.clutter;
}

}  // namespace montecarta::filters
