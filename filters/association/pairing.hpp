// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/slam_filter.hpp"
#include "filters/setup/filter_setup.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

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

/// What one map's pairings of a scan are, seen with the simulator's eyes. `made_of` {slot}: the
/// identity of the detection that each landmark of the map was made of, before this scan's new
/// ones. Counting only: no estimate may depend on it.
AssociationCounts association_counts(Scan scan, std::span<const Pairing> pairings,
                                     std::span<const std::int32_t> made_of);

/// Adds `share` times the counts of one particle.
void add(const AssociationCounts& counts, double share, AssociationCounts& sum);

/// For every particle and landmark of its map the simulator's identity of the detection that the
/// landmark was made of, to count association errors by. Keeps its memory from run to run.
class InitialisationIdentities {
 public:
  explicit InitialisationIdentities(std::size_t particles)
      : counts_(particles), spare_counts_(particles) {}

  void clear() { std::ranges::fill(counts_, 0U); }
  /// By slot.
  std::span<const std::int32_t> of(std::size_t particle) const {
    return {identities_.data() + particle * room_, counts_[particle]};
  }
  void add(std::size_t particle, std::int32_t identity) {
    if (counts_[particle] == room_) widen();
    identities_[particle * room_ + counts_[particle]++] = identity;
  }
  /// Particle i becomes a copy of particle parents[i].
  void resample(std::span<const std::uint32_t> parents) {
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      std::ranges::copy(of(parents[i]), spare_.begin() + static_cast<std::ptrdiff_t>(i * room_));
      spare_counts_[i] = counts_[parents[i]];
    }
    std::swap(identities_, spare_);
    std::swap(counts_, spare_counts_);
  }

 private:
  void widen() {
    const std::size_t wider = std::max<std::size_t>(16, 2 * room_);
    spare_.assign(counts_.size() * wider, 0);
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      std::ranges::copy(of(i), spare_.begin() + static_cast<std::ptrdiff_t>(i * wider));
    }
    std::swap(identities_, spare_);
    spare_.assign(identities_.size(), 0);
    room_ = wider;
  }

  std::size_t room_ = 0;  ///< landmarks of a particle that fit
  std::vector<std::int32_t> identities_, spare_;
  std::vector<std::uint32_t> counts_, spare_counts_;  ///< {particle} landmarks
};

}  // namespace montecarta::filters
