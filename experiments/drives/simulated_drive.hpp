// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/pose.hpp"
#include "engine/random/stream.hpp"
#include "experiments/drives/scenario.hpp"
#include "experiments/worlds/world.hpp"
#include "filters/models/field_of_view.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::experiments {

/// A landmark in view, as a perfect sensor would see it.
struct VisibleLandmark {
  std::int32_t identity = 0;
  Eigen::Vector2d detection;  ///< components of the sensor
};

/// Measured ranges are never below this [m], however large the noise (EQUATIONS 2).
inline constexpr double kLeastRange = 1e-3;

/// The sensor of a simulated vehicle (EQUATIONS 1 and 2).
class SimulatedSensor {
 public:
  explicit SimulatedSensor(const Scenario& scenario);

  /// Calls visit(observation) for everything in view from `pose`, in increasing identity.
  template <class Visit>
  void see(const Pose& pose, std::span<const Eigen::Vector2d> landmarks, const Visit& visit) const {
    view_.look(pose, landmarks, [&](const InView& seen) {
      const double bearing = wrap(std::atan2(seen.dy, seen.dx) - seen.heading);
      visit(VisibleLandmark{static_cast<std::int32_t>(seen.landmark),
                            detection_of(sensor_, {seen.range, bearing})});
    });
  }

  /// Appends the detection of `observation`, with noise, unless it is missed. `place` names study
  /// seed, run and step; every landmark has its own numbers, so that what one sees shifts no other.
  void detect(const VisibleLandmark& observation, const StreamIdentity& place,
              std::vector<Detection>& detections) const;
  /// Appends the false alarms of one scan, uniform over the area in view.
  void add_clutter(const StreamIdentity& place, std::vector<Detection>& detections) const;

 private:
  Detection noisy(const Eigen::Vector2d& exact, std::int32_t identity, RngStream* noise) const;

  Sensor sensor_;
  Eigen::Vector2d sigma_;  ///< of the components
  FieldOfView view_;
  double min_range_;
  double max_range_;
  double field_of_view_;
  double miss_probability_;
  double clutter_rate_;
};

/// Steers from way-point to way-point, loop after loop (EQUATIONS 1). `waypoints` and `scenario`
/// must outlive it.
class WaypointPilot {
 public:
  WaypointPilot(const std::vector<Eigen::Vector2d>& waypoints, const Scenario& scenario)
      : waypoints_(&waypoints), scenario_(&scenario) {}

  /// Notes whether the way-point ahead is reached at `pose`; at most one a step.
  void look_ahead(const Pose& pose);
  /// The control for the next step from `pose`.
  const Control& steer(const Pose& pose);

  std::uint32_t loops_done() const { return loops_done_; }
  std::size_t next_waypoint() const { return next_; }

 private:
  const std::vector<Eigen::Vector2d>* waypoints_;
  const Scenario* scenario_;
  std::size_t next_ = 0;
  std::uint32_t loops_done_ = 0;
  Control control_;  ///< of the step before
};

/// Draws the map of a run: every landmark displaced from where the world has it, uniformly within a
/// distance. A pure function of (study seed, run).
class RandomMap {
 public:
  /// `places` [m] in the world; `shift` [m] at most.
  RandomMap(std::vector<Eigen::Vector2d> places, double shift, std::uint64_t seed)
      : places_(std::move(places)), shift_(shift), seed_(seed) {}

  /// [m] by identity.
  std::vector<Eigen::Vector2d> operator()(std::uint64_t run) const;

 private:
  std::vector<Eigen::Vector2d> places_;
  double shift_;
  std::uint64_t seed_;
};

/// More steps than this in one run would not fit a result file; a study of so many is a slip of the
/// pen.
inline constexpr std::size_t kMostSteps = 20'000'000;

/// A vehicle simulated along the way-points of a world (EQUATIONS 1). Every run has the steps and
/// scans of the noise-free drive; where noise moves the truth it drives on along the loop. The
/// noise depends on (seed, run) only.
class SimulatedDrive final : public DriveSource {
 public:
  /// Throws StudyError where a way-point cannot be reached or the drive is longer than kMostSteps.
  SimulatedDrive(World world, const Scenario& scenario, std::uint64_t seed);
  SimulatedDrive(const SimulatedDrive&) = delete;
  SimulatedDrive& operator=(const SimulatedDrive&) = delete;

  const Itinerary& itinerary() const override { return itinerary_; }
  void generate(std::uint64_t run, Drive& drive) const override;

 private:
  void drive_without_noise();
  void fill_itinerary();
  void find_visible_landmarks();
  using Landmarks = std::span<const Eigen::Vector2d>;
  void generate_measured(std::uint64_t run, Drive& drive) const;
  void generate_matched(std::uint64_t run, Landmarks landmarks, Drive& drive) const;
  void move_measured(std::uint64_t run, Drive& drive) const;
  void scan(const StreamIdentity& here, const Pose& pose, Landmarks landmarks, Drive& drive) const;
  void end_scan(const StreamIdentity& here, Drive& drive) const;
  std::size_t expected_detections() const;
  /// `control` with the noise of that run and step.
  Control noisy(const Control& control, std::uint64_t run, std::size_t step) const;
  StreamIdentity place(std::uint64_t run, std::size_t step) const;

  World world_;
  Scenario scenario_;
  std::uint64_t seed_;
  SimulatedSensor sensor_;
  std::optional<RandomMap> random_map_;  ///< nullopt: every run has the world's landmarks
  Itinerary itinerary_;
  std::vector<Control> nominal_;              ///< controls of the noise-free drive
  std::vector<Pose> path_;                    ///< its poses after each step
  std::vector<VisibleLandmark> visible_;      ///< of all its scans
  std::vector<std::uint32_t> visible_begin_;  ///< scans + 1 offsets into visible_
};

}  // namespace montecarta::experiments
