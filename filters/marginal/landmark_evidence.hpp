// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/weights.hpp"
#include "filters/marginal/marginal_options.hpp"
#include "filters/marginal/shared_map.hpp"
#include "filters/moments/sensor_noise.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace montecarta::filters {

/// Gauss-Newton's equations for the place of a landmark: information times step = gradient.
struct NormalEquations {
  Symmetric2<double> information;  ///< Sum of H' R^-1 H [1/m^2]
  Point gradient;                  ///< Sum of H' R^-1 nu [1/m]
};

/// What one detection, made from all weighted poses, says about where its landmark is. Candidate
/// places are the same for all particles; the sums run over particles in lanes.
template <class Real>
class LandmarkEvidence {
 public:
  /// Looks along the detection from every pose. The weights must outlive this.
  void look(const std::vector<BasicPose<Real>>& poses, const Weights<Real>& weights,
            const RangeBearing<double>& seen, const SensorNoise& noise, MapObjective objective) {
    weights_ = &weights;
    objective_ = objective;
    range_ = seen.range;
    per_range_noise_ = 1.0 / noise.range;
    per_bearing_noise_ = 1.0 / noise.bearing;
    rays_.resize(poses.size());
    terms_.resize(poses.size());
    for (std::size_t b = 0; b < poses.size(); ++b) {
      rays_[b] = {{poses[b].x, poses[b].y},
                  direction_of(Real(poses[b].heading + Real(seen.bearing)))};
    }
  }

  /// The objective at `place`, in units of a chi-square (EQUATIONS 14): the less the better.
  double cost(const Point& place) {
    return objective_ == MapObjective::likelihood ? minus_two_log_likelihood(place)
                                                  : mean_square(place);
  }

  /// At `place`, after its cost(): every particle counts as much as it explains.
  NormalEquations normal_equations(const Point& place) const {
    return sums(place, [&](std::size_t b) {
      return objective_ == MapObjective::likelihood ? exp(terms_[b] - Real(log_sum_)) : share(b);
    });
  }
  /// Sum of w H' R^-1 H at `place` (EQUATIONS 14).
  Symmetric2<double> information(const Point& place) const {
    return sums(place, [&](std::size_t b) { return weights_->linear()[b]; }).information;
  }

 private:
  struct Ray {
    BasicPoint<Real> from;
    Direction<Real> along;  ///< where the detection points
  };
  /// A place seen from a pose: the innovation, and the way to the place.
  struct VisibleLandmark {
    Real dx, dy, squared_range, range;
    Real range_error, bearing_error;  ///< detected minus predicted
  };

  [[gnu::always_inline]] VisibleLandmark observation(std::size_t b, const Point& place) const {
    const Ray& ray = rays_[b];
    VisibleLandmark s;
    s.dx = Real(place.x) - ray.from.x;
    s.dy = Real(place.y) - ray.from.y;
    s.squared_range = fma(s.dx, s.dx, s.dy * s.dy);
    s.range = sqrt(s.squared_range);
    s.range_error = Real(range_) - s.range;
    // in the detection's frame the predicted bearing is the innovation, and needs no wrapping
    const Real along = fma(s.dx, ray.along.cosine, s.dy * ray.along.sine);
    const Real across = fma(s.dx, ray.along.sine, -(s.dy * ray.along.cosine));
    s.bearing_error = atan2(across, along);
    return s;
  }
  [[gnu::always_inline]] Real squared(const VisibleLandmark& s) const {
    return fma(s.range_error * s.range_error, Real(per_range_noise_),
               s.bearing_error * s.bearing_error * Real(per_bearing_noise_));
  }

  /// What a block counts in a mean of squares; dead lanes count nothing.
  Real share(std::size_t b) const {
    const Real& weight = weights_->linear()[b];
    if (objective_ == MapObjective::squares) return weight;
    const double even = 1.0 / static_cast<double>(weights_->particles());
    return select(weights_->log(b) > Real(-std::numeric_limits<double>::infinity()), Real(even),
                  Real(0.0));
  }

  double mean_square(const Point& place) const {
    Real sum(0.0);
    for (std::size_t b = 0; b < rays_.size(); ++b)
      sum = fma(share(b), squared(observation(b, place)), sum);
    return sum_of_lanes(sum);
  }

  /// -2 log Sum w exp(-squared / 2), with the greatest term taken out first.
  double minus_two_log_likelihood(const Point& place) {
    Real peaks(-std::numeric_limits<double>::max());
    for (std::size_t b = 0; b < rays_.size(); ++b) {
      terms_[b] = weights_->log(b) - Real(0.5) * squared(observation(b, place));
      peaks = max(peaks, terms_[b]);
    }
    double peak = get(peaks, 0);
    for (std::size_t lane = 1; lane < kLanesOf<Real>; ++lane)
      peak = std::max(peak, get(peaks, lane));
    Real sum(0.0);
    for (const Real& term : terms_) sum += exp(term - Real(peak));
    log_sum_ = peak + std::log(sum_of_lanes(sum));
    return -2.0 * log_sum_;
  }

  template <class Count>
  NormalEquations sums(const Point& place, const Count& count) const {
    std::array<Real, 5> S;
    S.fill(Real(0.0));
    for (std::size_t b = 0; b < rays_.size(); ++b) {
      const VisibleLandmark s = observation(b, place);
      const auto near = s.range < Real(kLeastDistance);  // no bearing has a derivative there
      const Real per_square = select(near, Real(0.0), Real(1.0) / s.squared_range);
      const Real per_range = s.range * per_square;
      const Real ux = s.dx * per_range, uy = s.dy * per_range;       // range by place
      const Real vx = -(s.dy * per_square), vy = s.dx * per_square;  // bearing by place
      const Real r = count(b) * Real(per_range_noise_), a = count(b) * Real(per_bearing_noise_);
      const Real re = r * s.range_error, ae = a * s.bearing_error;
      S[0] += r * ux * ux + a * vx * vx;
      S[1] += r * ux * uy + a * vx * vy;
      S[2] += r * uy * uy + a * vy * vy;
      S[3] += re * ux + ae * vx;
      S[4] += re * uy + ae * vy;
    }
    return {{sum_of_lanes(S[0]), sum_of_lanes(S[1]), sum_of_lanes(S[2])},
            {sum_of_lanes(S[3]), sum_of_lanes(S[4])}};
  }

  const Weights<Real>* weights_ = nullptr;
  MapObjective objective_ = MapObjective::likelihood;
  double range_ = 0.0;
  double per_range_noise_ = 0.0, per_bearing_noise_ = 0.0;
  std::vector<Ray> rays_;
  std::vector<Real> terms_;  ///< of the last likelihood: log of weight times density
  double log_sum_ = 0.0;     ///< of the terms
};

}  // namespace montecarta::filters
