// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/slam_filter.hpp"
#include "engine/random/stream.hpp"
#include "engine/threads/parallel.hpp"
#include "filters/factory.hpp"
#include "filters/models/ackermann.hpp"
#include "filters/models/range_bearing.hpp"
#include "filters/setup/filter_setup.hpp"

#include <array>
#include <cmath>
#include <concepts>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace montecarta::filters {

using OptionTexts = std::map<std::string, std::string, std::less<>>;

/// A filter's options as a newcomer gets them, but for those of `others`.
inline FilterOptions default_options(const FilterKind& kind, const OptionTexts& others = {}) {
  OptionTexts values = others;
  for (const Parameter& option : kind.options) values.emplace(option.key, *option.fallback);
  return FilterOptions(values);
}

/// Noise so small that the models are linear within it: there EKF-SLAM is the Kalman filter of its
/// world.
inline Belief fine() {
  return {.vehicle = {},
          .control = {.sigma = {3e-3, 5e-4}},
          .sigma_range = 1e-3,
          .sigma_bearing = 2e-4};
}

/// A world for tests of filters: a vehicle on a circle of 27 m among landmarks, with noise on its
/// motion.
struct SmallWorld {
  Itinerary itinerary;
  Drive drive;
  std::uint64_t seed = 1;
};

struct SmallWorldSettings {
  std::uint64_t seed = 1;
  std::size_t landmarks = 20;
  std::size_t scans = 40;
  std::size_t steps_per_scan = 8;
  double max_range = 30.0;  ///< [m] of the pose, in front only
  Belief noise = {};        ///< of the truth
  /// Alternates from scan to scan.
  std::vector<Control> controls = std::vector<Control>(1, Control{3.0, 0.15});
};

/// The setup of a filter for a world of these settings; options not in `others` are the defaults.
inline FilterSetup setup_for(const FilterKind& kind, const SmallWorldSettings& world,
                             const OptionTexts& others = {},
                             Association association = Association::known) {
  return {.belief = world.noise,
          .association = {.kind = association},
          .options = default_options(kind, others),
          .landmarks = world.landmarks};
}
/// The setup of a filter that is given the map.
inline FilterSetup in_known_map(FilterSetup setup) {
  setup.map_is_known = true;
  setup.association.new_gate = std::numeric_limits<double>::infinity();
  return setup;
}
inline std::unique_ptr<SlamFilter> make_filter(const FilterKind& kind,
                                               const SmallWorldSettings& world,
                                               const OptionTexts& others = {},
                                               Association association = Association::known) {
  return kind.make(setup_for(kind, world, others, association));
}

inline void place_landmarks(const SmallWorldSettings& settings, SmallWorld& world) {
  for (std::uint32_t k = 0; k < settings.landmarks; ++k) {
    RngStream draw({settings.seed, 0, 0, k, Draw::world_landmark});
    const double angle = kTwoPi * draw.uniform();
    const double radius = 10.0 + 30.0 * draw.uniform();
    world.itinerary.landmarks.emplace_back(radius * std::cos(angle),
                                           27.0 + radius * std::sin(angle));
  }
}

inline void look_around(const SmallWorldSettings& settings, std::uint32_t step, const Pose& truth,
                        SmallWorld& world) {
  for (std::uint32_t k = 0; k < settings.landmarks; ++k) {
    const Eigen::Vector2d& f = world.itinerary.landmarks[k];
    const auto observation = predicted_observation(truth, Point{f.x(), f.y()});
    if (observation.range >= settings.max_range || std::abs(observation.bearing) >= kPi / 2.0)
      continue;
    RngStream draw({settings.seed, 0, step, k, Draw::world_detection});
    const Sensor& sensor = settings.noise.sensor;
    const Eigen::Vector2d exact = linearised_detection(sensor, truth, Point{f.x(), f.y()})->value;
    Detection detection{.values = {}, .identity = static_cast<std::int32_t>(k)};
    std::size_t i = 0;
    for (const Quantity quantity : components_of(sensor)) {
      const double value = exact(static_cast<Eigen::Index>(i)) +
                           deviation_of(quantity, settings.noise) * draw.normal();
      detection[i++] = wraps(quantity) ? wrap(value) : value;
    }
    world.drive.detections.push_back(detection);
  }
  world.drive.scan_begin.push_back(static_cast<std::uint32_t>(world.drive.detections.size()));
}

/// The step of a vehicle that is driven by `driven` instead of `control`, with the noise of a step.
inline BodyStep<double> noisy_step(const SmallWorldSettings& settings, std::uint32_t step,
                                   const Control& control, const Control& driven) {
  const Vehicle& vehicle = settings.noise.vehicle;
  const BodyStep<double> moved = body_step(vehicle, driven, 0.025);
  const IncrementNoise& noise = settings.noise.control.increment;
  if (noise.is_none()) return moved;
  RngStream draw({settings.seed, 0, step, 0, Draw::world_increment});
  std::array<double, 3> e{};
  for (double& one : e) one = draw.normal();
  return perturbed(moved, noise.model,
                   increment_deviations(noise, body_step(vehicle, control, 0.025), 0.025), e);
}

inline SmallWorld small_world(const SmallWorldSettings& settings) {
  SmallWorld world{.itinerary = {}, .drive = {}, .seed = settings.seed};
  place_landmarks(settings, world);
  world.drive.scan_begin.push_back(0);
  Pose truth = world.itinerary.start;
  const auto n_steps = static_cast<std::uint32_t>(settings.scans * settings.steps_per_scan);
  for (std::uint32_t step = 0; step < n_steps; ++step) {
    RngStream draw({settings.seed, 0, step, 0, Draw::world_control});
    const std::size_t leg = (step / settings.steps_per_scan) % settings.controls.size();
    const Control& control = settings.controls[leg];
    Control driven = control;
    const std::size_t n_controls = controls_of(settings.noise.vehicle).size();
    for (std::size_t i = 0; i < n_controls; ++i) {
      driven[i] += settings.noise.control.sigma[i] * draw.normal();
    }
    truth = moved_by(truth, noisy_step(settings, step, control, driven));
    world.itinerary.step_time.push_back(0.025 * (step + 1));
    world.drive.controls.push_back(control);
    world.drive.truth.push_back(truth);
    if ((step + 1) % settings.steps_per_scan != 0) continue;
    world.itinerary.scan_step.push_back(step);
    look_around(settings, step, truth, world);
  }
  return world;
}

/// The same drive, with a filter that knows map and start with these deviations. Its errors are
/// drawn.
inline SmallWorld in_known_map(SmallWorld world, const PriorDeviations& deviations) {
  const auto error = [&](Draw purpose, std::uint32_t index, double deviation) {
    RngStream draw({world.seed, 0, 0, index, purpose});
    const double x = draw.normal(), y = draw.normal();
    return Eigen::Vector3d(deviation * x, deviation * y, draw.normal());
  };
  const Eigen::Vector3d e = error(Draw::world_start, 0, deviations.position);
  const Pose& start = world.itinerary.start;
  Prior prior{.pose = {{start.x - e(0), start.y - e(1), start.heading - deviations.heading * e(2)},
                       deviations.start_covariance()}};
  for (std::uint32_t k = 0; k < world.itinerary.landmarks.size(); ++k) {
    prior.map.push_back(
        {world.itinerary.landmarks[k] - error(Draw::world_survey, k, deviations.landmark).head<2>(),
         deviations.landmark_covariance()});
  }
  world.drive.prior = prior;
  return world;
}

/// The same drive with a fix of the position, with the deviation of `belief`, at every n-th scan.
inline SmallWorld with_fixes(SmallWorld world, const Belief& belief, std::size_t every = 1) {
  world.drive.fixes.resize(world.itinerary.scans());
  for (std::size_t s = every - 1; s < world.itinerary.scans(); s += every) {
    const std::uint32_t step = world.itinerary.scan_step[s];
    RngStream draw({world.seed, 0, step, 0, Draw::world_fix});
    const double x = draw.normal(), y = draw.normal(), sigma = belief.sigma_fix.value();
    const Pose& truth = world.drive.truth[step];
    world.drive.fixes[s] = PositionFix(truth.x + sigma * x, truth.y + sigma * y);
  }
  return world;
}

/// `pose` in a world that is turned about the origin by the heading of `start` and shifted to it.
inline Pose turned(const Pose& pose, const Pose& start) {
  const Direction<double> turn = direction_of(start.heading);
  return {start.x + turn.cosine * pose.x - turn.sine * pose.y,
          start.y + turn.sine * pose.x + turn.cosine * pose.y, wrap(pose.heading + start.heading)};
}

/// The same prior in a world that is turned in this way. Covariances must not depend on directions.
inline Prior turned(Prior prior, const Pose& start) {
  prior.pose.mean = turned(prior.pose.mean, start);
  for (LandmarkEstimate& known : prior.map) {
    const Pose place = turned(Pose{known.mean.x(), known.mean.y(), 0.0}, start);
    known.mean = {place.x, place.y};
  }
  return prior;
}

/// The same drive in a world that is turned about the origin by the heading of `start` and shifted
/// to it.
inline SmallWorld turned(const SmallWorld& world, const Pose& start) {
  SmallWorld other = world;
  for (Eigen::Vector2d& f : other.itinerary.landmarks) {
    const Pose place = turned(Pose{f.x(), f.y(), 0.0}, start);
    f = {place.x, place.y};
  }
  for (std::optional<PositionFix>& fix : other.drive.fixes) {
    if (!fix) continue;
    const Pose place = turned(Pose{fix->x(), fix->y(), 0.0}, start);
    fix = PositionFix(place.x, place.y);
  }
  other.itinerary.start = start;
  if (world.drive.prior) other.drive.prior = turned(*world.drive.prior, start);
  return other;
}

/// Starts `filter` from the prior of the world or, if there is none, at `start`.
template <class Filter>
void start_in(const SmallWorld& world, const Pose& start, Filter& filter,
              const Parallel& parallel = Parallel::serial()) {
  if constexpr (std::derived_from<Filter, SlamFilter>) {
    const StepContext context(world.seed, 0, 0, parallel);
    if (world.drive.prior) return filter.start_from(context, *world.drive.prior);
  }
  filter.start(start);
}

/// Updates `filter` with the fix and the scan of this number, as the engine does.
template <class Filter>
void update_with_scan(Filter& filter, const StepContext& context, const SmallWorld& world,
                      std::size_t scan) {
  if constexpr (std::derived_from<Filter, SlamFilter>) {
    if (const auto fix = world.drive.fix(scan)) filter.take_fix(*fix);
  }
  filter.update(context, world.drive.scan(scan));
}

/// Drives `filter` through the world as the engine does; calls after_scan(scan number) behind every
/// update.
template <class Filter, class AfterScan>
void drive_through(Filter& filter, const SmallWorld& world, const Pose& start,
                   const AfterScan& after_scan, const Parallel& parallel = Parallel::serial()) {
  start_in(world, start, filter, parallel);
  std::size_t scan = 0;
  for (std::size_t step = 0; step < world.itinerary.steps(); ++step) {
    const StepContext context(world.seed, 0, static_cast<std::uint32_t>(step), parallel);
    filter.predict(context, world.drive.controls[step], world.itinerary.duration(step));
    if (scan == world.itinerary.scans() || world.itinerary.scan_step[scan] != step) continue;
    update_with_scan(filter, context, world, scan);
    after_scan(scan++);
  }
}
template <class Filter>
void drive_through(Filter& filter, const SmallWorld& world, const Pose& start = {}) {
  drive_through(filter, world, start, [](std::size_t) {});
}

/// The estimates of a filter after every scan.
inline std::vector<PoseMoments> estimates_of(SlamFilter& filter, const SmallWorld& world,
                                             const Pose& start = {}) {
  std::vector<PoseMoments> estimates;
  drive_through(filter, world, start,
                [&](std::size_t) { estimates.push_back(filter.estimate().spread); });
  return estimates;
}

}  // namespace montecarta::filters
