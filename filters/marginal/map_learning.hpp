// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/evolution/evolution_report.hpp"
#include "filters/marginal/shared_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace montecarta::filters {

/// The normal equations for the position of a landmark: information times step = gradient.
struct NormalEquations {
  Symmetric2<double> information;  ///< Sum of H' R^-1 H [1/m^2]
  Point gradient;                  ///< Sum of H' R^-1 nu [1/m]
};

/// The objective of a landmark's position, given one detection from all weighted poses (EQUATIONS
/// 14). Candidate positions are the same for all particles; sums over particles run in lanes.
template <class Real>
class LandmarkEvidence {
 public:
  /// Prepares the rays of the detection from every pose. `weights` must outlive this object.
  void look(const std::vector<BasicPose<Real>>& poses, const Weights<Real>& weights,
            const RangeBearing<double>& seen, const SensorNoise& noise, MapObjective objective) {
    weights_ = &weights;
    objective_ = objective;
    range_ = seen.range;
    per_range_noise_ = 1.0 / noise.first;
    per_bearing_noise_ = 1.0 / noise.second;
    rays_.resize(poses.size());
    terms_.resize(poses.size());
    for (std::size_t b = 0; b < poses.size(); ++b) {
      rays_[b] = {{poses[b].x, poses[b].y},
                  direction_of(Real(poses[b].heading + Real(seen.bearing)))};
    }
  }

  /// The objective at `place`, on the scale of a chi-square (EQUATIONS 14); less is better.
  double cost(const Point& place) {
    return objective_ == MapObjective::likelihood ? minus_two_log_likelihood(place)
                                                  : mean_square(place);
  }

  /// The normal equations at `place`, after its cost(); each particle counts by its own fit.
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
    Direction<Real> along;  ///< direction of the detection
  };
  /// The innovation for a position observed from a pose, and the vector to the position.
  struct LandmarkInView {
    Real dx, dy, squared_range, range;
    Real range_error, bearing_error;  ///< detected minus predicted values
  };

  [[gnu::always_inline]] LandmarkInView observation(std::size_t b, const Point& place) const {
    const Ray& ray = rays_[b];
    LandmarkInView s;
    s.dx = Real(place.x) - ray.from.x;
    s.dy = Real(place.y) - ray.from.y;
    s.squared_range = fma(s.dx, s.dx, s.dy * s.dy);
    s.range = sqrt(s.squared_range);
    s.range_error = Real(range_) - s.range;
    // In the frame of the detection the predicted bearing is the innovation and needs no wrapping.
    const Real along = fma(s.dx, ray.along.cosine, s.dy * ray.along.sine);
    const Real across = fma(s.dx, ray.along.sine, -(s.dy * ray.along.cosine));
    s.bearing_error = atan2(across, along);
    return s;
  }
  [[gnu::always_inline]] Real squared(const LandmarkInView& s) const {
    return fma(s.range_error * s.range_error, Real(per_range_noise_),
               s.bearing_error * s.bearing_error * Real(per_bearing_noise_));
  }

  /// Weights of a block in the sum of squares; lanes without a particle have the weight 0.
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

  /// -2 log Sum w exp(-squared / 2), with the largest term factored out.
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
      const LandmarkInView s = observation(b, place);
      const auto near = s.range < Real(kLeastDistance);  // the bearing has no derivative there
      const Real per_square = select(near, Real(0.0), Real(1.0) / s.squared_range);
      const Real per_range = s.range * per_square;
      const Real ux = s.dx * per_range, uy = s.dy * per_range;       // d range / d position
      const Real vx = -(s.dy * per_square), vy = s.dx * per_square;  // d bearing / d position
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
  std::vector<Real> terms_;  ///< at the last likelihood: log of weight times density
  double log_sum_ = 0.0;     ///< log of their sum
};

/// Initialises landmarks of the shared map and updates them with a scan (EQUATIONS 14).
template <class Real>
class MapLearning {
 public:
  MapLearning(const MapSettings& settings, const SensorNoise& noise)
      : settings_(settings), noise_(noise) {}

  /// Returns whether the positions of landmarks evolve.
  bool evolves() const { return settings_.solver == MapSolver::de; }

  /// A landmark observed for the first time: the mean of the positions given by the particles, with
  /// the information of one detection.
  SharedLandmark initialised(const StepContext& context, const std::vector<BasicPose<Real>>& poses,
                             const Weights<Real>& weights, const RangeBearing<double>& seen) const {
    const auto mean = weighted_sums<Real, 2>(context, weights, [&](std::size_t b) {
      const BasicPoint<Real> place =
          linearised_place(poses[b], {Real(seen.range), Real(seen.bearing)}).point;
      return std::array<Real, 2>{place.x, place.y};
    });
    const Pose centre =
        weighted_mean<Real>(context, weights, [&](std::size_t b) { return poses[b]; });
    const LandmarkGaussian<double> one =
        Linearised().initialise(centre, Measurement<double>{seen.range, seen.bearing}, noise_);
    return {{mean[0], mean[1]}, inverted(one.covariance)};
  }

  /// Updates a landmark that is observed again, unless it is known exactly. `index` selects its
  /// random numbers; candidates are placed along and across `heading` [rad], so that a rotated
  /// world is searched alike. What evolution does is added to `report`.
  void learn(const StepContext& context, std::uint32_t index, double heading,
             const std::vector<BasicPose<Real>>& poses, const Weights<Real>& weights,
             const RangeBearing<double>& seen, SharedLandmark& landmark, EvolutionReport& report) {
    if (landmark.is_exact) return;
    evidence_.look(poses, weights, seen, noise_, settings_.objective);
    prior_ = settings_.mode == MapMode::recursive ? landmark : SharedLandmark{landmark.mean, {}};
    if (settings_.mode == MapMode::onestep_threshold &&
        cost(landmark.mean) <= settings_.threshold) {
      return;  // the landmark is in the dead zone of EQUATIONS 14
    }
    landmark.mean = settings_.solver == MapSolver::de
                        ? evolved_place(context.identity(Draw::evolution, index), heading, seen,
                                        landmark.information, report)
                        : gauss_newton_place();
    const Symmetric2<double> more = evidence_.information(landmark.mean);
    if (!(more.xx > 0.0)) return;  // all poses coincide with the landmark
    landmark.information = {prior_.information.xx + more.xx, prior_.information.xy + more.xy,
                            prior_.information.yy + more.yy};
  }

 private:
  static constexpr int kMostSteps = 20;
  // [m] a shorter step is taken even if the cost does not fall.
  static constexpr double kSurelyGood = 1e-6;
  static constexpr double kShortStep = 1e-12;  // [m] a shorter step is the last one

  /// J of EQUATIONS (14.2): the objective of the detection plus the prior.
  double cost(const Point& place) {
    const Point d{place.x - prior_.mean.x, place.y - prior_.mean.y};
    const Symmetric2<double>& L = prior_.information;
    return evidence_.cost(place) + L.xx * d.x * d.x + 2.0 * L.xy * d.x * d.y + L.yy * d.y * d.y;
  }

  /// Descends from the old position as long as the cost falls. The last steps are too short to
  /// change the cost.
  Point gauss_newton_place() {
    Point place = prior_.mean;
    double here = cost(place);
    for (int k = 0; k < kMostSteps; ++k) {
      const Point step = gauss_newton_step(place);
      const Point next{place.x + step.x, place.y + step.y};
      const double way = length(step.x, step.y), there = cost(next);
      if (!(there < here) && !(way < kSurelyGood)) return place;
      place = next, here = there;
      if (way < kShortStep) return place;
    }
    return place;
  }
  Point gauss_newton_step(const Point& place) const {
    const NormalEquations equations = evidence_.normal_equations(place);
    const Symmetric2<double>&L = prior_.information, &A = equations.information;
    const Point d{place.x - prior_.mean.x, place.y - prior_.mean.y};
    return solve({A.xx + L.xx, A.xy + L.xy, A.yy + L.yy},
                 {equations.gradient.x - L.xx * d.x - L.xy * d.y,
                  equations.gradient.y - L.xy * d.x - L.yy * d.y});
  }

  /// Differential evolution over offsets from the old position, which is the first member. The
  /// others are uniform within three standard deviations of the sensor (EQUATIONS 14).
  /// `known` is the information about the landmark before the scan.
  Point evolved_place(const StreamIdentity& identity, double heading,
                      const RangeBearing<double>& seen, const Symmetric2<double>& known,
                      EvolutionReport& report) {
    const Direction<double> ahead = direction_of(heading);
    const double half =
        3.0 * std::max(std::sqrt(noise_.first), seen.range * std::sqrt(noise_.second));
    const auto place = [&](const Offset& o) {
      return Point{prior_.mean.x + ahead.cosine * o[0] - ahead.sine * o[1],
                   prior_.mean.y + ahead.sine * o[0] + ahead.cosine * o[1]};
    };
    scatter(identity, half);
    EvolutionSettings evolution = settings_.evolution;
    if (settings_.mode == MapMode::onestep_threshold) evolution.good_enough = -settings_.threshold;
    const SearchBox<double, 2> box{{0.0, 0.0}, {half, half}};
    const EvolutionDraws draws{identity, static_cast<std::uint32_t>(population_.size())};
    const auto fittest = evolve<double, 2>(
        population_, box, evolution, draws, scratch_,
        one_by_one([&](std::size_t, const Offset& o) { return -cost(place(o)); }));
    const Point found = place(fittest.best);
    const double dx = found.x - prior_.mean.x, dy = found.y - prior_.mean.y;
    // The fitness is on the scale of a chi-square, twice that of a log-likelihood.
    report.add({population_.size(), fittest.generations, 0.5 * fittest.gain_of_best,
                std::sqrt(known.xx * dx * dx + 2.0 * known.xy * dx * dy + known.yy * dy * dy)});
    return found;
  }
  void scatter(const StreamIdentity& identity, double half) {
    population_.assign(settings_.population, Offset{});
    for (std::size_t k = 1; k < population_.size(); ++k) {
      const auto u = uniform_pairs(identity, static_cast<std::uint32_t>(k), double());
      population_[k] = {half * (2.0 * u.first - 1.0), half * (2.0 * u.second - 1.0)};
    }
  }

  using Offset = std::array<double, 2>;  ///< ahead and to the left [m]

  MapSettings settings_;
  SensorNoise noise_;
  LandmarkEvidence<Real> evidence_;
  SharedLandmark prior_;  ///< prior of the landmark that is updated
  std::vector<Offset> population_;
  EvolutionScratch<double, 2> scratch_;
};

}  // namespace montecarta::filters
