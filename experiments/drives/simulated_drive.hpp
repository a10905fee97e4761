// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/pose.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"
#include "experiments/worlds/world.hpp"
#include "filters/models/field_of_view.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::experiments {

/// The noise of the controls acts on the filter's input or on the truth (EQUATIONS 1).
enum class NoiseMode {
  measured_control,  ///< the truth follows the nominal control; the filter is given a noisy one
  matched,           ///< the truth follows a noisy control; the filter is given the nominal one
};

/// The steering of a simulated vehicle (EQUATIONS 1).
enum class Pilot {
  closed_loop,  ///< steering by the true pose, so that controls depend on the truth
  open_loop,    ///< the controls of the noise-free drive along the way-points
  constant      ///< controls that are held for Scenario::drive_time
};

/// The positions of the landmarks in each run.
enum class MapPlacement {
  fixed,  ///< positions of the world in every run
  random  ///< positions displaced in every run, uniformly within Scenario::map_shift
};

/// The drive of a simulated vehicle through a world, and its sensor (study file: [scenario]).
struct Scenario {
  NoiseMode noise = NoiseMode::measured_control;
  Pilot pilot = Pilot::closed_loop;
  MapPlacement map = MapPlacement::fixed;
  double map_shift = 10.0;           ///< [m] largest displacement of a landmark of a random map
  double drive_time = 60.0;          ///< [s] duration of the drive of Pilot::constant
  double constant_turn = 0.0;        ///< its last control: steering angle [rad] or yaw rate [rad/s]
  std::uint32_t loops = 1;           ///< number of times round the way-points
  std::uint32_t steps_per_scan = 8;  ///< number of control steps per scan
  double control_rate = 40.0;        ///< [Hz] control steps per second
  Vehicle vehicle = {};
  double speed = 3.0;  ///< [m/s] speed of the vehicle
  /// Noise of the controls, e.g. [m/s], [rad].
  ControlNoise control{.sigma = {0.3, 3.0 * kPi / 180.0}};
  double sigma_range = 0.1;                  ///< [m] standard deviation of a range
  double sigma_bearing = 1.0 * kPi / 180.0;  ///< [rad] standard deviation of a bearing
  double max_range = 30.0;                   ///< [m] largest measured range
  double field_of_view = kPi;     ///< [rad] full angle, centred on the axis of the sensor
  double waypoint_radius = 1.0;   ///< [m] distance within which a way-point is reached
  double clutter_rate = 0.0;      ///< mean number of false alarms per scan
  double miss_probability = 0.0;  ///< probability that a visible landmark is not detected
  Pose start{};                   ///< pose before the first step
  Sensor sensor = {};             ///< its components determine which deviations are used
  /// [m] standard deviation of a relative position along the sensor's axis.
  double sigma_forward = 0.1;
  double sigma_left = 0.1;  ///< [m] standard deviation of a relative position across that axis
  double min_range = 0.0;   ///< [m] least measured range
  /// Number of scans from one fix of the position to the next; 0: there are none.
  std::uint32_t scans_per_fix = 0;
  double sigma_fix = 1.0;  ///< [m] standard deviation of a fix, in x and in y
};

/// A landmark in view and its detection by a sensor without noise.
struct VisibleLandmark {
  std::int32_t identity = 0;
  Eigen::Vector2d detection;  ///< values of the components that the sensor measures
};

/// Lower bound of measured ranges [m], for noise of any size (EQUATIONS 2).
inline constexpr double kLeastRange = 1e-3;

/// The sensor of a simulated vehicle (EQUATIONS 1 and 2).
class SimulatedSensor {
 public:
  explicit SimulatedSensor(const Scenario& scenario);

  /// Calls visit(observation) for every landmark in view from `pose`, in increasing identity.
  template <class Visit>
  void see(const Pose& pose, std::span<const Eigen::Vector2d> landmarks, const Visit& visit) const {
    view_.look(pose, landmarks, [&](const InView& seen) {
      const double bearing = wrap(std::atan2(seen.dy, seen.dx) - seen.heading);
      visit(VisibleLandmark{static_cast<std::int32_t>(seen.landmark),
                            detection_of(scenario_.sensor, {seen.range, bearing})});
    });
  }

  /// Appends the noisy detection of `observation`, unless it is missed. `place` gives the study's
  /// seed, run and step. Every landmark has its own random numbers, so that a detection does not
  /// change those of other landmarks.
  void detect(const VisibleLandmark& observation, const StreamIdentity& place,
              std::vector<Detection>& detections) const;
  /// Appends the false alarms of one scan, uniform over the area in view.
  void add_clutter(const StreamIdentity& place, std::vector<Detection>& detections) const;

 private:
  Detection noisy(const Eigen::Vector2d& exact, std::int32_t identity, RngStream* noise) const;

  Scenario scenario_;
  Eigen::Vector2d sigma_;  ///< standard deviations of the components of a detection
  FieldOfView view_;
};

/// Steers from way-point to way-point, loop after loop (EQUATIONS 1). `waypoints` and `scenario`
/// must outlive the pilot.
class WaypointPilot {
 public:
  WaypointPilot(const std::vector<Eigen::Vector2d>& waypoints, const Scenario& scenario)
      : waypoints_(&waypoints), scenario_(&scenario) {}

  /// Advances to the next way-point if the current one is reached at `pose`. Advances by at most
  /// one way-point per step.
  void look_ahead(const Pose& pose);
  /// Returns the control for the next step from `pose`.
  const Control& steer(const Pose& pose);

  std::uint32_t loops_done() const { return loops_done_; }
  std::size_t next_waypoint() const { return next_; }

 private:
  const std::vector<Eigen::Vector2d>* waypoints_;
  const Scenario* scenario_;
  std::size_t next_ = 0;
  std::uint32_t loops_done_ = 0;
  Control control_;  ///< control of the step before
};

/// Draws the map of a run: every landmark is displaced uniformly within a distance of its place in
/// the world. A pure function of (study seed, run).
class RandomMap {
 public:
  /// `places` are the positions in the world [m], `shift` is the largest displacement [m].
  RandomMap(std::vector<Eigen::Vector2d> places, double shift, std::uint64_t seed)
      : places_(std::move(places)), shift_(shift), seed_(seed) {}

  /// [m] Positions of a run by identity.
  std::vector<Eigen::Vector2d> operator()(std::uint64_t run) const;

 private:
  std::vector<Eigen::Vector2d> places_;
  double shift_;
  std::uint64_t seed_;
};

/// Largest number of steps of a run. More would not fit a result file, and are probably a typing
/// error in the study.
inline constexpr std::size_t kMostSteps = 20'000'000;

/// A vehicle simulated along the way-points of a world, or with constant controls (EQUATIONS 1).
/// Every run has the steps and scans of the noise-free drive. If noise moves the truth, the vehicle
/// keeps driving along the loop until the last step. The noise depends on (seed, run) only.
class SimulatedDrive final : public DriveSource {
 public:
  /// Throws StudyError if a way-point cannot be reached or the drive has more than kMostSteps
  /// steps.
  SimulatedDrive(World world, const Scenario& scenario, std::uint64_t seed);
  SimulatedDrive(const SimulatedDrive&) = delete;
  SimulatedDrive& operator=(const SimulatedDrive&) = delete;

  const Itinerary& itinerary() const override { return itinerary_; }
  void generate(std::uint64_t run, Drive& drive) const override;

 private:
  void drive_without_noise();
  void drive_along_waypoints();
  void hold_controls();
  void take_step(const Pose& from, const Control& control);
  void fill_itinerary();
  void find_visible_landmarks();
  using Landmarks = std::span<const Eigen::Vector2d>;
  void generate_measured(std::uint64_t run, Drive& drive) const;
  void generate_matched(std::uint64_t run, Landmarks landmarks, Drive& drive) const;
  void move_measured(std::uint64_t run, Drive& drive) const;
  void scan(const StreamIdentity& here, const Pose& pose, Landmarks landmarks, Drive& drive) const;
  void end_scan(const StreamIdentity& here, Drive& drive) const;
  void take_fixes(std::uint64_t run, Drive& drive) const;
  std::size_t expected_detections() const;
  /// Returns the step of a vehicle that is given `control`, with the noise of this run and step.
  BodyStep<double> noisy_step(const Control& control, std::uint64_t run, std::size_t step) const;
  /// Returns `control` with the noise of this run and step.
  Control noisy(const Control& control, std::uint64_t run, std::size_t step) const;
  StreamIdentity place(std::uint64_t run, std::size_t step) const;

  World world_;
  Scenario scenario_;
  std::uint64_t seed_;
  SimulatedSensor sensor_;
  std::optional<RandomMap> random_map_;  ///< nullopt if every run has the landmarks of the world
  Itinerary itinerary_;
  std::vector<Control> nominal_;  ///< controls of the noise-free drive
  std::vector<Pose> path_;        ///< poses of the noise-free drive after each step
  /// Landmarks in view at all scans of the noise-free drive.
  std::vector<VisibleLandmark> visible_;
  std::vector<std::uint32_t> visible_begin_;  ///< scans + 1 offsets into visible_
};

}  // namespace montecarta::experiments
