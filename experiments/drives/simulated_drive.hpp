// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/pose.hpp"
#include "experiments/drives/scenario.hpp"
#include "experiments/drives/simulated_sensor.hpp"
#include "experiments/worlds/world.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::experiments {

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
