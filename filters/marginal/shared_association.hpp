// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/association/association_counts.hpp"
#include "filters/association/nearest.hpp"
#include "filters/marginal/shared_map.hpp"
#include "filters/moments/gaussians.hpp"
#include "filters/moments/sensor_noise.hpp"

#include <cstdint>
#include <vector>

namespace montecarta {

/// A detection and the landmark that it is.
struct SharedMatch {
  std::uint32_t landmark;
  RangeBearing<double> seen;
};

/// Which landmark of the shared map a detection is, once for all particles: by identity, or the
/// nearest to a Gaussian pose (EQUATIONS 17).
class SharedAssociation {
 public:
  explicit SharedAssociation(const FilterSetup& setup);

  void clear();
  bool known() const { return settings_.kind == Association::known; }
  /// By identity.
  void associate(Scan scan);
  /// By nearness. `map_is_exact`: the innovation knows no covariance of the map.
  void associate(Scan scan, const SharedMap& map, bool map_is_exact, const PoseMoments& predicted);

  bool found_nothing() const { return matches_.empty() && fresh_.empty(); }
  const std::vector<SharedMatch>& matches() const { return matches_; }
  /// Detections of landmarks not seen before.
  const std::vector<Detection>& fresh() const { return fresh_; }
  /// Against the simulator's identities.
  const AssociationCounts& counts() const { return counts_; }
  /// log p0 for every detection that matches nothing, if association is not known (EQUATIONS 17).
  double unmatched_log_density() const;

  /// Remembers that a fresh detection became the landmark at `slot`; throws where the map has run
  /// away.
  void give_slot(const Detection& fresh, std::size_t slot);
  /// Where row k of the reported map is, or a slot that does not exist.
  std::size_t slot_of_row(std::size_t k) const;

 private:
  static constexpr std::uint32_t kUnseen = 0xffffffffU;

  void sort_out(Scan scan, const std::vector<Pairing>& pairings);

  AssociationSettings settings_;
  SensorNoise noise_;
  double log_new_density_;
  std::vector<std::uint32_t> slot_of_identity_;
  std::vector<SharedMatch> matches_;
  std::vector<Detection> fresh_;
  std::size_t unmatched_ = 0;
  std::vector<std::int32_t> made_of_;  ///< {slot} identity at birth, to count errors only
  AssociationCounts counts_;
  std::vector<Pairing> pairings_;  ///< scratch
};

}  // namespace montecarta
