// SPDX-License-Identifier: BSD-3-Clause
#include "filters/marginal/shared_map.hpp"

#include <cmath>

namespace montecarta::filters {

void SharedAssociation::associate(Scan scan) {
  pair_by_identity(scan);
  sort_out(scan);
}

void SharedAssociation::associate(Scan scan, const SharedMap& map, bool map_is_exact,
                                  const PoseMoments& predicted) {
  const Symmetric3<double> P = symmetric_of(predicted.covariance);
  searches_.assign(scan.size(), {});
  for (std::size_t k = 0; k < scan.size(); ++k) {
    for (std::uint32_t slot = 0; slot < map.size(); ++slot) {
      const auto s = line_of_sight(predicted.mean, map[slot].mean);
      if (!is_usable(s)) continue;
      const auto covariance = map_is_exact ? Symmetric2<double>{} : map[slot].covariance();
      const auto v =
          innovation_of(P, s, residual(measurement_of<double>(scan[k]), s), covariance, noise_);
      const double distance = v.squared();
      searches_[k].offer(slot, distance, distance + std::log(v.S.determinant()), settings().gate);
    }
  }
  pair_nearest(scan, searches_);
  sort_out(scan);
}

void SharedAssociation::sort_out(Scan scan) {
  matches_.clear();
  fresh_.clear();
  unmatched_ = 0;
  for (std::size_t k = 0; k < scan.size(); ++k) {
    const Pairing& pairing = pairings()[k];
    unmatched_ += pairing.kind != PairingKind::matched;
    if (pairing.kind == PairingKind::fresh) fresh_.push_back(scan[k]);
    if (pairing.kind == PairingKind::matched)
      matches_.push_back({pairing.landmark, observation_of(scan[k])});
  }
}

}  // namespace montecarta::filters
