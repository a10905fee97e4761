// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_setup.hpp"

#include <cstdint>
#include <limits>
#include <span>

namespace montecarta::filters {

/// What becomes of a detection.
enum class PairingKind : std::uint8_t {
  ignored,  ///< too far from every landmark to be one, too near to be new; or it lost to a rival
  matched,  ///< it is `landmark`
  fresh,    ///< a landmark not seen before
};

/// A detection judged by one map.
struct Pairing {
  PairingKind kind = PairingKind::ignored;
  std::uint32_t landmark = 0;  ///< where matched
  double cost = 0.0;           ///< where matched: ND = D^2 + log det S
};

/// The search for the landmark that explains one detection best (EQUATIONS 17): offer every
/// landmark of the map, in any order but always the same one, then judge.
struct NearestSearch {
  double least_distance = std::numeric_limits<double>::infinity();  ///< D^2 over all offered
  double least_cost = std::numeric_limits<double>::infinity();  ///< ND over those inside the gate
  std::uint32_t landmark = 0;                                   ///< that has the least cost

  /// `distance` = D^2 = v' S^-1 v, `cost` = ND = D^2 + log det S; of equals the first offered wins.
  void offer(std::uint32_t candidate, double distance, double cost, double gate) {
    if (distance < least_distance) least_distance = distance;
    if (distance < gate && cost < least_cost) {
      least_cost = cost;
      landmark = candidate;
    }
  }
};

/// Matched with the least cost inside the gate; fresh where even the nearest is beyond the outer
/// gate or there is none; ignored between the gates.
Pairing judge(const NearestSearch& search, const AssociationSettings& settings);

/// Of detections that chose one landmark only that with the least cost keeps it; the rest are
/// ignored. Of equals the first wins.
void exclude_rivals(std::span<Pairing> pairings);

/// log p0 of EQUATIONS (17.2): what a detection that matches nothing contributes to a particle's
/// log-weight, so that all particles weigh by the same number of factors: log N at the inner gate
/// with S = diag(2 R), plus the offset.
double log_new_density(const AssociationSettings& settings, const Belief& belief);

}  // namespace montecarta::filters
