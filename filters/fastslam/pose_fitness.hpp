// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/gaussian_draw.hpp"
#include "filters/moments/linearised.hpp"

#include <span>
#include <vector>

namespace montecarta::filters {

/// A detection and the landmark that a particle takes it for.
template <class Real>
struct MatchedDetection {
  LandmarkGaussian<Real> landmark;
  RangeBearing<Real> seen;
  Real matched;  ///< 1, or 0 where the particle takes it for nothing it knows
};

/// Appends what the particles of block b, once fetched, take every match of a scan for.
template <class Real, class Associating>
void append_matched(const Associating& association, std::size_t b,
                    std::vector<MatchedDetection<Real>>& scan) {
  for (std::size_t k = 0; k < association.matches(); ++k) {
    const auto& [landmark, seen, mask] = association.match(b, k);
    scan.push_back({landmark, seen, as_number<Real>(mask)});
  }
}

/// How well a pose explains a scan.
template <class Real>
class PoseFitness {
 public:
  PoseFitness(const PoseGaussian<Real>& predicted, const SensorNoise& noise)
      : predicted_(predicted), noise_(noise) {}

  /// Log of Ankishan eq. (32) read for range and bearing: sum of -1/2 nu' R^-1 nu (EQUATIONS 10).
  /// Neither the motion nor the map's covariance counts.
  Real likelihood(const BasicPose<Real>& pose, std::span<const MatchedDetection<Real>> scan) const {
    Real sum(0.0);
    for (const MatchedDetection<Real>& one : scan) {
      const RangeBearing<Real> nu = residual(one.seen, line_of_sight(pose, one.landmark.mean));
      sum += one.matched *
             (nu.range * nu.range / noise_.range + nu.bearing * nu.bearing / noise_.bearing);
    }
    return -0.5 * sum;
  }

  /// Log of the pose's posterior density up to a constant: the map's covariance in the innovation,
  /// and the prediction as prior (EQUATIONS 10).
  Real posterior(const BasicPose<Real>& pose, std::span<const MatchedDetection<Real>> scan) const {
    Evidence<Real> evidence;
    for (const MatchedDetection<Real>& one : scan) {
      const LineOfSight<Real> s = line_of_sight(pose, one.landmark.mean);
      const auto use = one.matched > Real(0.5) && is_usable(s);
      const Turned<Real> map = turned(one.landmark.covariance, s);
      const auto [r, b] = residual(one.seen, s);
      const Symmetric2<Real> S{noise_.range + map.along, map.cross * s.per_range,
                               noise_.bearing + map.across * s.per_range * s.per_range};
      const Real determinant = S.determinant(), squared = S.adjugate_form(r, b) / determinant;
      evidence.add(select(use, squared, Real(0.0)), select(use, determinant, Real(1.0)),
                   as_number<Real>(use), one.matched);
    }
    return evidence.log_density() + predicted_(pose);
  }

 private:
  PoseDensity<Real> predicted_;
  SensorNoise noise_;
};

}  // namespace montecarta::filters
