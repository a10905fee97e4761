// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/drives/simulated_drive.hpp"

#include "engine/errors.hpp"
#include "engine/numbers/real.hpp"
#include "experiments/text/words.hpp"
#include "filters/models/ackermann.hpp"

#include <algorithm>
#include <array>

namespace montecarta::experiments {
namespace {

StreamIdentity with(StreamIdentity place, Draw purpose, std::int32_t index) {
  place.purpose = purpose;
  place.index = static_cast<std::uint32_t>(index);
  return place;
}

/// Draws a Poisson number by multiplying uniforms (Knuth); `mean` should be small.
std::uint32_t poisson(double mean, RngStream& draw) {
  const double limit = std::exp(-mean);
  std::uint32_t count = 0;
  for (double product = draw.uniform(); product > limit; product *= draw.uniform()) ++count;
  return count;
}

}  // namespace

SimulatedSensor::SimulatedSensor(const Scenario& scenario)
    : scenario_(scenario),
      sigma_(deviations_of(scenario.sensor, scenario)),
      view_(scenario.max_range, scenario.field_of_view, scenario.sensor.mounting,
            scenario.min_range) {}

/// Makes a detection of exact values, with noise if `noise` is given. It is limited to values that
/// the sensor can measure.
Detection SimulatedSensor::noisy(const Eigen::Vector2d& exact, std::int32_t identity,
                                 RngStream* noise) const {
  Detection detection{.values = {}, .identity = identity};
  std::size_t i = 0;
  for (const Quantity quantity : components_of(scenario_.sensor)) {
    const auto at = static_cast<Eigen::Index>(i);
    double value = exact(at);
    if (noise != nullptr) value += sigma_(at) * noise->normal();
    if (quantity == Quantity::range) value = std::max(value, kLeastRange);
    detection[i++] = wraps(quantity) ? wrap(value) : value;
  }
  return detection;
}

void SimulatedSensor::detect(const VisibleLandmark& observation, const StreamIdentity& place,
                             std::vector<Detection>& detections) const {
  const bool missed = scenario_.miss_probability > 0.0 &&
                      RngStream(with(place, Draw::world_miss, observation.identity)).uniform() <
                          scenario_.miss_probability;
  if (missed) return;
  RngStream draw(with(place, Draw::world_detection, observation.identity));
  detections.push_back(noisy(observation.detection, observation.identity, &draw));
}

void SimulatedSensor::add_clutter(const StreamIdentity& place,
                                  std::vector<Detection>& detections) const {
  if (scenario_.clutter_rate == 0.0) return;
  RngStream draw(with(place, Draw::world_clutter, 0));
  for (std::uint32_t left = poisson(scenario_.clutter_rate, draw); left > 0; --left) {
    const double share = draw.uniform(), inner = scenario_.min_range / scenario_.max_range;
    const double range = scenario_.max_range * std::sqrt(share + (1.0 - share) * inner * inner);
    const double bearing = scenario_.field_of_view * (draw.uniform() - 0.5);
    const Eigen::Vector2d exact = detection_of(scenario_.sensor, {range, bearing});
    detections.push_back(noisy(exact, Detection::kClutter, nullptr));
  }
}

void WaypointPilot::look_ahead(const Pose& pose) {
  const Eigen::Vector2d& ahead = (*waypoints_)[next_];
  const double dx = ahead.x() - pose.x;
  const double dy = ahead.y() - pose.y;
  if (dx * dx + dy * dy >= scenario_->waypoint_radius * scenario_->waypoint_radius) return;
  next_ = (next_ + 1) % waypoints_->size();
  if (next_ == 0) ++loops_done_;
}

const Control& WaypointPilot::steer(const Pose& pose) {
  const Eigen::Vector2d& ahead = (*waypoints_)[next_];
  const double course = std::atan2(ahead.y() - pose.y, ahead.x() - pose.x);
  control_ = steered(scenario_->vehicle, {.before = control_,
                                          .off = course - pose.heading,
                                          .speed = scenario_->speed,
                                          .control_rate = scenario_->control_rate});
  return control_;
}

namespace {

/// [m] Length of one step.
double step_length(const Scenario& scenario) { return scenario.speed / scenario.control_rate; }

/// Largest distance [m] that may be driven until a way-point is reached. After it, the way-point
/// counts as missed.
double time_limit(const Pose& pose, const Eigen::Vector2d& waypoint, const Scenario& scenario) {
  const double distance = length(waypoint.x() - pose.x, waypoint.y() - pose.y);
  return 3.0 * distance + 10.0 * way_to_turn(scenario.vehicle, scenario.speed);
}

[[noreturn]] void throw_unreachable(const World& world, std::size_t waypoint,
                                    const Scenario& scenario) {
  const std::string place =
      world.waypoint_places.empty() ? "world " + world.name : world.waypoint_places.at(waypoint);
  const std::string radius = to_text(scenario.waypoint_radius);
  const double step = step_length(scenario);
  if (step > scenario.waypoint_radius) {
    throw StudyError(
        "{}: way-point {} is not reached within {} m (the vehicle steps over it, {} m at a time): "
        "lower scenario.speed, or enlarge scenario.control_rate or scenario.waypoint_radius",
        place, waypoint + 1, radius, to_text(step));
  }
  throw StudyError(
      "{}: way-point {} is not reached within {} m (the vehicle circles around it): enlarge "
      "scenario.waypoint_radius or scenario.{}, or move the way-point",
      place, waypoint + 1, radius, turn_limit_key(scenario.vehicle));
}

[[noreturn]] void throw_too_long(const World& world, const Scenario& scenario) {
  const std::string remedy =
      scenario.pilot == Pilot::constant ? "a shorter scenario.drive_time" : "fewer scenario.loops";
  throw StudyError(
      "world {}: a run has more than {} steps (no result file would hold it): use {} or a lower "
      "scenario.control_rate",
      world.name, kMostSteps, remedy);
}

}  // namespace

std::vector<Eigen::Vector2d> RandomMap::operator()(std::uint64_t run) const {
  std::vector<Eigen::Vector2d> landmarks;
  StreamIdentity identity{
      .seed = seed_, .run = run, .step = 0, .index = 0, .purpose = Draw::world_landmark};
  for (const Eigen::Vector2d& place : places_) {
    RngStream draw(identity);
    ++identity.index;
    const double distance = shift_ * std::sqrt(draw.uniform());  // uniform over the disc
    const double direction = kTwoPi * draw.uniform();
    landmarks.emplace_back(place.x() + distance * std::cos(direction),
                           place.y() + distance * std::sin(direction));
  }
  return landmarks;
}

SimulatedDrive::SimulatedDrive(World world, const Scenario& scenario, std::uint64_t seed)
    : world_(std::move(world)), scenario_(scenario), seed_(seed), sensor_(scenario) {
  if (scenario_.map == MapPlacement::random) {
    random_map_.emplace(world_.landmarks, scenario_.map_shift, seed_);
  }
  drive_without_noise();
  fill_itinerary();
  find_visible_landmarks();
}

void SimulatedDrive::generate(std::uint64_t run, Drive& drive) const {
  drive.controls.resize(itinerary_.steps());
  drive.truth.resize(itinerary_.steps());
  drive.detections.clear();
  drive.detections.reserve(expected_detections());
  drive.scan_begin.reserve(itinerary_.scans() + 1);
  drive.scan_begin.assign(1, 0);
  std::vector<Eigen::Vector2d> own;
  if (random_map_) own = (*random_map_)(run);
  if (scenario_.noise == NoiseMode::matched) {
    generate_matched(run, random_map_ ? own : world_.landmarks, drive);
  } else if (random_map_) {
    move_measured(run, drive);
    for (const std::uint32_t step : itinerary_.scan_step) {
      scan(place(run, step), path_[step], own, drive);
    }
  } else {
    generate_measured(run, drive);
  }
  take_fixes(run, drive);
}

/// Fixes are taken at every n-th scan, n = scans_per_fix. Their noise is drawn apart from that of
/// the detections.
void SimulatedDrive::take_fixes(std::uint64_t run, Drive& drive) const {
  drive.fixes.clear();
  if (scenario_.scans_per_fix == 0) return;
  drive.fixes.resize(itinerary_.scans());
  for (std::size_t s = scenario_.scans_per_fix; s <= itinerary_.scans();
       s += scenario_.scans_per_fix) {
    const std::uint32_t step = itinerary_.scan_step[s - 1];
    RngStream draw(with(place(run, step), Draw::world_fix, 0));
    const double x = draw.normal(), y = draw.normal();
    const Pose& truth = drive.truth[step];
    drive.fixes[s - 1] =
        PositionFix(truth.x + scenario_.sigma_fix * x, truth.y + scenario_.sigma_fix * y);
  }
}

void SimulatedDrive::drive_without_noise() {
  scenario_.pilot == Pilot::constant ? hold_controls() : drive_along_waypoints();
}

void SimulatedDrive::take_step(const Pose& from, const Control& control) {
  if (nominal_.size() == kMostSteps) throw_too_long(world_, scenario_);
  nominal_.push_back(control);
  path_.push_back(move(from, control, 1.0 / scenario_.control_rate, scenario_.vehicle));
}

void SimulatedDrive::hold_controls() {
  Control control{scenario_.speed};
  control[controls_of(scenario_.vehicle).size() - 1] = scenario_.constant_turn;
  const double steps = std::round(scenario_.drive_time * scenario_.control_rate);
  for (double k = 0.0; k < steps; k += 1.0)
    take_step(path_.empty() ? scenario_.start : path_.back(), control);
}

void SimulatedDrive::drive_along_waypoints() {
  WaypointPilot pilot(world_.waypoints, scenario_);
  const double step = step_length(scenario_);
  std::size_t target = pilot.next_waypoint();
  Pose pose = scenario_.start;
  double left = time_limit(pose, world_.waypoints[target], scenario_);
  for (pilot.look_ahead(pose); pilot.loops_done() < scenario_.loops; pilot.look_ahead(pose)) {
    if (pilot.next_waypoint() != target) {
      target = pilot.next_waypoint();
      left = time_limit(pose, world_.waypoints[target], scenario_);
    }
    if ((left -= step) < 0.0) throw_unreachable(world_, target, scenario_);
    take_step(pose, pilot.steer(pose));
    pose = path_.back();
  }
}

void SimulatedDrive::fill_itinerary() {
  const std::size_t steps = nominal_.size();
  itinerary_.step_time.reserve(steps);
  for (std::size_t k = 0; k < steps; ++k) {
    itinerary_.step_time.push_back(static_cast<double>(k + 1) / scenario_.control_rate);
  }
  const std::uint32_t every = scenario_.steps_per_scan;
  for (std::size_t counter = every; counter <= steps; counter += every) {
    itinerary_.scan_step.push_back(static_cast<std::uint32_t>(counter - 1));
  }
  itinerary_.landmarks = world_.landmarks;
  itinerary_.waypoints = world_.waypoints;
  itinerary_.start = scenario_.start;
  itinerary_.moving_controls = moving_controls(controls_of(scenario_.vehicle));
}

void SimulatedDrive::find_visible_landmarks() {
  visible_begin_.assign(1, 0);
  for (const std::uint32_t step : itinerary_.scan_step) {
    sensor_.see(path_[step], world_.landmarks,
                [this](const VisibleLandmark& observation) { visible_.push_back(observation); });
    visible_begin_.push_back(static_cast<std::uint32_t>(visible_.size()));
  }
}

void SimulatedDrive::move_measured(std::uint64_t run, Drive& drive) const {
  drive.truth = path_;
  for (std::size_t k = 0; k < nominal_.size(); ++k) {
    drive.controls[k] = noisy(nominal_[k], run, k);
  }
}

/// Generates a run in which the true path, and so the landmarks in view, are the same as in all
/// runs.
void SimulatedDrive::generate_measured(std::uint64_t run, Drive& drive) const {
  move_measured(run, drive);
  for (std::size_t s = 0; s < itinerary_.scans(); ++s) {
    const StreamIdentity here = place(run, itinerary_.scan_step[s]);
    for (std::size_t i = visible_begin_[s]; i < visible_begin_[s + 1]; ++i) {
      sensor_.detect(visible_[i], here, drive.detections);
    }
    end_scan(here, drive);
  }
}

void SimulatedDrive::generate_matched(std::uint64_t run, Landmarks landmarks, Drive& drive) const {
  const bool is_open = scenario_.pilot != Pilot::closed_loop;
  WaypointPilot pilot(world_.waypoints, scenario_);
  Pose pose = scenario_.start;
  for (std::size_t k = 0; k < itinerary_.steps(); ++k) {
    pilot.look_ahead(pose);
    drive.controls[k] = is_open ? nominal_[k] : pilot.steer(pose);
    pose = moved_by(pose, noisy_step(drive.controls[k], run, k));
    drive.truth[k] = pose;
    if ((k + 1) % scenario_.steps_per_scan == 0) scan(place(run, k), pose, landmarks, drive);
  }
}

void SimulatedDrive::scan(const StreamIdentity& here, const Pose& pose, Landmarks landmarks,
                          Drive& drive) const {
  sensor_.see(pose, landmarks, [&](const VisibleLandmark& observation) {
    sensor_.detect(observation, here, drive.detections);
  });
  end_scan(here, drive);
}

void SimulatedDrive::end_scan(const StreamIdentity& here, Drive& drive) const {
  sensor_.add_clutter(here, drive.detections);
  drive.scan_begin.push_back(static_cast<std::uint32_t>(drive.detections.size()));
}

/// Number of detections to reserve: twice the nominal number and some more, since a path with noise
/// has slightly more or fewer landmarks in view than the nominal one.
std::size_t SimulatedDrive::expected_detections() const {
  const double clutter = scenario_.clutter_rate * static_cast<double>(itinerary_.scans());
  return 2 * (visible_.size() + static_cast<std::size_t>(clutter)) + 1000;
}

BodyStep<double> SimulatedDrive::noisy_step(const Control& control, std::uint64_t run,
                                            std::size_t step) const {
  const double duration = 1.0 / scenario_.control_rate;
  const BodyStep<double> moved = body_step(scenario_.vehicle, noisy(control, run, step), duration);
  const IncrementNoise& noise = scenario_.control.increment;
  if (noise.is_none()) return moved;
  RngStream draw(with(place(run, step), Draw::world_increment, 0));
  std::array<double, 3> e{};
  for (double& one : e) one = draw.normal();
  const BodyStep<double> given = body_step(scenario_.vehicle, control, duration);
  return perturbed(moved, noise.model, increment_deviations(noise, given, duration), e);
}

Control SimulatedDrive::noisy(const Control& control, std::uint64_t run, std::size_t step) const {
  StreamIdentity identity = place(run, step);
  identity.purpose = Draw::world_control;
  RngStream draw(identity);
  const auto sigma = deviations_of(scenario_.control, control, scenario_.vehicle);
  Control result = control;
  const std::size_t controls = controls_of(scenario_.vehicle).size();
  for (std::size_t i = 0; i < controls; ++i) result[i] += sigma[i] * draw.normal();
  return result;
}

StreamIdentity SimulatedDrive::place(std::uint64_t run, std::size_t step) const {
  return {.seed = seed_,
          .run = run,
          .step = static_cast<std::uint32_t>(step),
          .index = 0,
          .purpose = Draw::world_control};
}

}  // namespace montecarta::experiments
