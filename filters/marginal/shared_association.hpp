// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/association/map_association.hpp"
#include "filters/marginal/shared_map.hpp"
#include "filters/moments/gaussians.hpp"
#include "filters/moments/sensor_noise.hpp"

#include <cstdint>
#include <vector>

namespace montecarta::filters {

/// A detection and the landmark that it is.
struct SharedMatch {
  std::uint32_t landmark;
  RangeBearing<double> seen;
};

/// A scan sorted by what it shows of the shared map, once for all particles: by identity, or by the
/// nearest to a Gaussian pose (EQUATIONS 17).
class SharedAssociation {
 public:
  explicit SharedAssociation(const FilterSetup& setup)
      : association_(setup), noise_(SensorNoise::of(setup.belief)) {}

  void clear() { association_.clear(); }
  bool known() const { return association_.known(); }
  /// By identity.
  void associate(Scan scan);
  /// By nearness. `map_is_exact`: the innovation knows no covariance of the map.
  void associate(Scan scan, const SharedMap& map, bool map_is_exact, const PoseMoments& predicted);

  bool matched_nothing() const { return matches_.empty() && fresh_.empty(); }
  const std::vector<SharedMatch>& matches() const { return matches_; }
  /// Detections of landmarks not seen before.
  const std::vector<Detection>& fresh() const { return fresh_; }
  const AssociationCounts& counts() const { return association_.counts(); }
  /// Of all detections that match nothing.
  double unmatched_log_density() const {
    return association_.unmatched_log_density() * static_cast<double>(unmatched_);
  }
  /// Remembers that a fresh detection became the map's next landmark.
  void add(const Detection& fresh) { association_.add(fresh); }
  /// Where row k of the reported map is, or a slot that does not exist.
  std::size_t slot_of_row(std::size_t k) const { return association_.slot_of(k); }

 private:
  void sort_out(Scan scan);

  MapAssociation association_;
  SensorNoise noise_;
  std::vector<SharedMatch> matches_;
  std::vector<Detection> fresh_;
  std::size_t unmatched_ = 0;
  std::vector<NearestSearch> searches_;  ///< scratch
};

}  // namespace montecarta::filters
