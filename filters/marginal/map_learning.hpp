// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/step_context.hpp"
#include "filters/evolution/differential_evolution.hpp"
#include "filters/marginal/landmark_evidence.hpp"
#include "filters/moments/linearised.hpp"
#include "filters/population/cloud_moments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace montecarta::filters {

/// How landmarks of the shared map are initialised, and how they learn from a scan (EQUATIONS 14).
template <class Real>
class MapLearning {
 public:
  MapLearning(const MapSettings& settings, const SensorNoise& noise)
      : settings_(settings), noise_(noise) {}

  /// A landmark seen for the first time: the mean of where the particles place it, as sure as one
  /// detection is.
  SharedLandmark initialised(const std::vector<BasicPose<Real>>& poses,
                             const Weights<Real>& weights, const RangeBearing<double>& seen) const {
    const auto mean = weighted_sums<Real, 2>(weights, [&](std::size_t b) {
      const BasicPoint<Real> place =
          linearised_place(poses[b], {Real(seen.range), Real(seen.bearing)}).point;
      return std::array<Real, 2>{place.x, place.y};
    });
    const Pose centre = weighted_mean<Real>(weights, [&](std::size_t b) { return poses[b]; });
    const Symmetric2<double> R = new_landmark(centre, seen, noise_).covariance;
    const Point x = solve(R, {1.0, 0.0}), y = solve(R, {0.0, 1.0});
    return {{mean[0], mean[1]}, {x.x, x.y, y.y}};
  }

  /// A landmark seen again. `index` names its random numbers; `heading` [rad] is the frame of
  /// candidates, so that a turned world is searched alike.
  void learn(const StepContext& context, std::uint32_t index, double heading,
             const std::vector<BasicPose<Real>>& poses, const Weights<Real>& weights,
             const RangeBearing<double>& seen, SharedLandmark& landmark) {
    evidence_.look(poses, weights, seen, noise_, settings_.objective);
    prior_ = settings_.mode == MapMode::recursive ? landmark : SharedLandmark{landmark.mean, {}};
    if (settings_.mode == MapMode::onestep_threshold &&
        cost(landmark.mean) <= settings_.threshold) {
      return;  // the dead zone of EQUATIONS 14
    }
    landmark.mean = settings_.solver == MapSolver::de
                        ? evolved_place(context.identity(Draw::evolution, index), heading, seen)
                        : gauss_newton_place();
    const Symmetric2<double> more = evidence_.information(landmark.mean);
    if (!(more.xx > 0.0)) return;  // all poses stand on the landmark
    landmark.information = {prior_.information.xx + more.xx, prior_.information.xy + more.xy,
                            prior_.information.yy + more.yy};
  }

 private:
  static constexpr int kMostSteps = 20;
  static constexpr double kSurelyGood = 1e-6;  // [m]
  static constexpr double kShortStep = 1e-12;  // [m]

  /// J of EQUATIONS 14: what the detection says plus what is known already.
  double cost(const Point& place) {
    const Point d{place.x - prior_.mean.x, place.y - prior_.mean.y};
    const Symmetric2<double>& L = prior_.information;
    return evidence_.cost(place) + L.xx * d.x * d.x + 2.0 * L.xy * d.x * d.y + L.yy * d.y * d.y;
  }

  /// From the old place downhill as long as it helps; the last steps are too short for the cost to
  /// show.
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

  /// DE over offsets from the old place, which is the first member; the others are scattered evenly
  /// over three sigmas of the sensor (EQUATIONS 14).
  Point evolved_place(const StreamIdentity& identity, double heading,
                      const RangeBearing<double>& seen) {
    const Direction<double> ahead = direction_of(heading);
    const double half =
        3.0 * std::max(std::sqrt(noise_.range), seen.range * std::sqrt(noise_.bearing));
    const auto place = [&](const Offset& o) {
      return Point{prior_.mean.x + ahead.cosine * o[0] - ahead.sine * o[1],
                   prior_.mean.y + ahead.sine * o[0] + ahead.cosine * o[1]};
    };
    scatter(identity, half);
    EvolutionSettings evolution = settings_.evolution;
    if (settings_.mode == MapMode::onestep_threshold) evolution.good_enough = -settings_.threshold;
    const SearchBox<double, 2> box{{0.0, 0.0}, {half, half}};
    const EvolutionDraws draws{identity, static_cast<std::uint32_t>(population_.size())};
    const auto fittest =
        evolve<double, 2>(population_, box, evolution, draws, scratch_,
                          OneByOne([&](std::size_t, const Offset& o) { return -cost(place(o)); }));
    return place(fittest.best);
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
  SharedLandmark prior_;  ///< of the landmark that learns
  std::vector<Offset> population_;
  EvolutionScratch<double, 2> scratch_;
};

}  // namespace montecarta::filters
