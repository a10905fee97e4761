// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"
#include "filters/association/pairing.hpp"
#include "filters/plain/landmark.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace montecarta::filters::plain {

/// Pairs every detection with the landmark that a detection of the same identity initialised.
inline std::vector<Pairing> pair_by_identity(Scan scan, std::span<const std::int32_t> identities) {
  std::vector<Pairing> pairings;
  for (const Detection& detection : scan) {
    const auto slot = std::ranges::find(identities, detection.identity) - identities.begin();
    const bool is_held = slot < std::ssize(identities);
    const PairingKind kind = detection.identity == Detection::kClutter ? PairingKind::ignored
                             : is_held                                 ? PairingKind::matched
                                                                       : PairingKind::fresh;
    pairings.push_back({kind, static_cast<std::uint32_t>(slot)});
  }
  return pairings;
}

/// The best landmark for one detection (EQUATIONS 17). `predict(j, detection)` is the optional
/// Innovation of landmark j.
template <class Predict>
Pairing nearest(const Detection& detection, std::size_t landmarks,
                const AssociationSettings& settings, const Predict& predict) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double least_distance = kInfinity;
  Pairing best{.cost = kInfinity};
  for (std::uint32_t j = 0; j < landmarks; ++j) {
    const std::optional<Innovation> v = predict(j, detection);
    if (!v) continue;
    const double D2 = squared_distance(v->nu, v->S);
    const double ND = D2 + std::log(v->S.determinant());
    least_distance = std::min(least_distance, D2);
    if (D2 < settings.gate && ND < best.cost) best = {PairingKind::matched, j, ND};
  }
  if (best.kind == PairingKind::matched) return best;
  return {.kind = least_distance > settings.new_gate ? PairingKind::fresh : PairingKind::ignored};
}

/// If several detections have matched landmark j, only the one of least cost keeps it.
inline void keep_best(std::uint32_t j, std::vector<Pairing>& pairings) {
  Pairing* best = nullptr;
  for (Pairing& one : pairings) {
    if (one.kind != PairingKind::matched || one.landmark != j) continue;
    const bool is_better = best == nullptr || one.cost < best->cost;
    if (best != nullptr) (is_better ? *best : one).kind = PairingKind::ignored;
    if (is_better) best = &one;
  }
}

/// Pairs every detection with its nearest neighbour in the map (EQUATIONS 17).
template <class Predict>
std::vector<Pairing> pair_nearest(Scan scan, std::size_t landmarks,
                                  const AssociationSettings& settings, const Predict& predict) {
  std::vector<Pairing> pairings;
  for (const Detection& detection : scan)
    pairings.push_back(nearest(detection, landmarks, settings, predict));
  for (std::uint32_t j = 0; j < landmarks; ++j) keep_best(j, pairings);
  return pairings;
}

/// The identities of a map.
inline std::vector<std::int32_t> identities_of(const Map& map) {
  std::vector<std::int32_t> identities;
  for (const Landmark& landmark : map) identities.push_back(landmark.identity);
  return identities;
}

/// Pairs the detections of a scan with a map as it is seen from the pose N(x, P); P is zero if the
/// pose is drawn already.
inline std::vector<Pairing> pair(Scan scan, const Map& map, const Vector<3>& x, const Matrix<3>& P,
                                 const FilterSetup& setup) {
  if (setup.association.kind == Association::known)
    return pair_by_identity(scan, identities_of(map));
  const auto predict = [&](std::uint32_t j, const Detection& z) {
    std::optional<Innovation> predicted;
    if (const auto v = innovation_at(x, map[j], z, observation_noise(setup.belief)))
      predicted = {v->nu, v->Hx * P * v->Hx.transpose() + v->Sf};
    return predicted;
  };
  return pair_nearest(scan, map.size(), setup.association, predict);
}

/// The slot of landmark k of a report: the one of identity k if identities are known, else the k-th
/// that was initialised; nullopt if the map does not have it.
inline std::optional<std::size_t> slot_of(std::size_t k, std::span<const std::int32_t> identities,
                                          Association association) {
  std::size_t slot = k;
  if (association == Association::known)
    slot = static_cast<std::size_t>(std::ranges::find(identities, static_cast<std::int32_t>(k)) -
                                    identities.begin());
  return slot < identities.size() ? std::optional(slot) : std::nullopt;
}

/// The logarithm that a detection without a match adds to a weight (EQUATIONS (17.2)); 0 if
/// identities are known.
inline double log_unmatched(const FilterSetup& setup) {
  if (setup.association.kind == Association::known) return 0.0;
  const Matrix<2> S = 2.0 * observation_noise(setup.belief);
  return -0.5 * setup.association.gate - 0.5 * std::log(S.determinant()) - std::log(kTwoPi) +
         setup.association.log_new_density_offset;
}

/// Throws std::runtime_error, which fails the run, if a map with unknown association has grown
/// beyond its limit.
inline void refuse_large_map(std::size_t landmarks, const AssociationSettings& settings) {
  if (settings.kind == Association::known || landmarks <= settings.most_landmarks) return;
  throw std::runtime_error("the map grew beyond " + std::to_string(settings.most_landmarks) +
                           " landmarks");
}

}  // namespace montecarta::filters::plain
