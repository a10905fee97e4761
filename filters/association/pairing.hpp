// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_setup.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// The result of associating a detection.
enum class PairingKind : std::uint8_t {
  ignored,  ///< neither near enough to a landmark nor far enough to be new, or lost to a rival
  matched,  ///< the detection belongs to the landmark Pairing::landmark
  fresh,    ///< the detection is the first of a new landmark
};

/// A detection and the landmark that one map associates with it.
struct Pairing {
  PairingKind kind = PairingKind::ignored;
  std::uint32_t landmark = 0;  ///< index of the landmark if the detection is matched
  double cost = 0.0;           ///< cost if the detection is matched: ND = D^2 + log det S
};

/// The search for the landmark that explains one detection best (EQUATIONS 17): offer() every
/// landmark of the map, always in the same order, then decide_pairing().
struct NearestSearch {
  /// Least D^2 of all landmarks that were offered.
  double least_distance = std::numeric_limits<double>::infinity();
  /// Least ND of the landmarks inside the gate.
  double least_cost = std::numeric_limits<double>::infinity();
  std::uint32_t landmark = 0;  ///< landmark of least cost

  /// `distance` is D^2 = v' S^-1 v, `cost` is ND = D^2 + log det S. Of equal costs the first wins.
  void offer(std::uint32_t candidate, double distance, double cost, double gate) {
    if (distance < least_distance) least_distance = distance;
    if (distance < gate && cost < least_cost) {
      least_cost = cost;
      landmark = candidate;
    }
  }
};

/// Matches the landmark of least cost inside the gate. Without one, the detection is fresh if the
/// nearest landmark is beyond the outer gate or the map is empty, else it is ignored.
Pairing decide_pairing(const NearestSearch& search, const AssociationSettings& settings);

/// If several detections matched the same landmark, only the one of least cost keeps it and the
/// others are ignored. Of equal costs the first wins.
void exclude_rivals(std::span<Pairing> pairings);

/// log p0 of EQUATIONS (17.2): the term that a detection without a match adds to the log-weight of
/// a particle, so that the weights of all particles have the same number of factors. It is log N at
/// the inner gate with S = diag(2 R), plus the offset.
double log_new_density(const AssociationSettings& settings, const Belief& belief);

/// Counts the correct and wrong pairings of one map by the simulator's identities. `made_of` {slot}
/// is the identity of the detection that initialised each landmark, without the landmarks that this
/// scan initialises. No estimate may depend on these counts.
AssociationCounts association_counts(Scan scan, std::span<const Pairing> pairings,
                                     std::span<const std::int32_t> made_of);

/// Adds `share` times the counts of one particle.
void add(const AssociationCounts& counts, double share, AssociationCounts& sum);

/// The simulator's identity of the detection that initialised each landmark of each particle, to
/// count association errors. Its memory is reused from run to run.
class InitialisationIdentities {
 public:
  explicit InitialisationIdentities(std::size_t particles)
      : counts_(particles), spare_counts_(particles) {}

  void clear() { std::ranges::fill(counts_, 0U); }
  /// {slot} identities of a particle.
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

  std::size_t room_ = 0;  ///< number of landmarks per particle that fit
  std::vector<std::int32_t> identities_, spare_;
  std::vector<std::uint32_t> counts_, spare_counts_;  ///< {particle} number of landmarks
};

}  // namespace montecarta::filters
