// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "engine/core/prior.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace montecarta::engine {

/// The control that a filter is given for one step. The vehicle defines the number of its
/// components and their meaning (EQUATIONS 1); components that it does not have are 0.
struct Control {
  static constexpr std::size_t kMost = 3;  ///< largest number of components
  std::array<double, kMost> values{};

  double operator[](std::size_t i) const { return values[i]; }
  double& operator[](std::size_t i) { return values[i]; }
  /// Returns whether the vehicle stands still, that is, whether its first `moving` components are
  /// all 0. It is then not predicted, independent of the noise of its motion (EQUATIONS 1).
  bool stands(std::size_t moving) const {
    return std::all_of(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(moving),
                       [](double value) { return value == 0.0; });
  }
};

/// One measurement of a landmark. The sensor defines the number of its components and their meaning
/// (EQUATIONS 2); components that it does not have are 0.
struct Detection {
  static constexpr std::size_t kMost = 2;            ///< largest number of components
  static constexpr std::int32_t kClutter = -1;       ///< identity of a false alarm
  static constexpr std::int32_t kUnidentified = -2;  ///< identity if it is not known
  /// Values of the components, for instance range [m], bearing [rad].
  std::array<double, kMost> values{};
  std::int32_t identity =
      kClutter;  ///< landmark of the world; filters may only use it with known association

  double operator[](std::size_t i) const { return values[i]; }
  double& operator[](std::size_t i) { return values[i]; }
};

/// A measurement of the position of the vehicle in the world [m].
using PositionFix = Eigen::Vector2d;

/// All detections of one instant; may be empty. Identities differ, except clutter and unidentified.
using Scan = std::span<const Detection>;

/// An independent measurement of the vehicle's path, against which a recorded drive is evaluated.
struct ReferencePath {
  std::string name;                       ///< name, for instance "gps"
  std::vector<double> time;               ///< [s] {fix} time, increasing
  std::vector<Eigen::Vector2d> position;  ///< [m] {fix} measured position
  std::vector<double> heading;  ///< [rad] {fix} measured heading; empty if it is not measured
  /// {fix} covariance of the error, (m, m, rad)^2; empty if it is not known. Without headings, only
  /// the block of the position counts.
  std::vector<Eigen::Matrix3d> covariance = {};

  /// Number of components of a fix: x, y and, if there are headings, the heading.
  int dimension() const { return heading.empty() ? 2 : 3; }
};

/// The part that all runs of a study share: the times of steps and scans, and the landmarks.
struct Itinerary {
  std::vector<double> step_time;           ///< [s] {step} time at its end
  std::vector<std::uint32_t> scan_step;    ///< {scan} index of the step after which it is taken
  std::vector<Eigen::Vector2d> landmarks;  ///< [m] true positions, by identity; empty if unknown
  std::vector<Eigen::Vector2d> waypoints;  ///< [m] way-points, for figures only; may be empty
  Pose start;  ///< pose before the first step, which the filter knows if it has no Prior
  std::vector<ReferencePath> references;  ///< references of a recorded drive
  std::size_t moving_controls = 1;        ///< number of leading components for Control::stands()
  bool has_truth = true;                  ///< true if drives have true poses, unlike recorded ones
  double longest_hold = 0.0;  ///< [s] longest time for which a row of recorded odometry holds

  std::size_t steps() const { return step_time.size(); }
  std::size_t scans() const { return scan_step.size(); }
  /// Length of step k [s].
  double duration(std::size_t k) const {
    return k == 0 ? step_time[0] : step_time[k] - step_time[k - 1];
  }
};

/// The input and the truth of one run. Buffers keep their memory from run to run.
struct Drive {
  std::vector<Control> controls;          ///< {step} control given to the filter
  std::vector<Pose> truth;                ///< {step} pose after the step; empty if unknown
  std::vector<Detection> detections;      ///< detections of all scans, in order
  std::vector<std::uint32_t> scan_begin;  ///< scans() + 1 offsets into `detections`
  /// {scan} fix of the position at the instant of each scan, if there is one; empty if the vehicle
  /// has no sensor of its position.
  std::vector<std::optional<PositionFix>> fixes = {};
  /// Knowledge of the filter before the first step; nullopt if it starts exactly at
  /// Itinerary::start and without landmarks.
  std::optional<Prior> prior = {};

  /// The fix at scan number `s`.
  std::optional<PositionFix> fix(std::size_t s) const {
    return fixes.empty() ? std::nullopt : fixes[s];
  }
  Scan scan(std::size_t s) const {
    return Scan(detections).subspan(scan_begin[s], scan_begin[s + 1] - scan_begin[s]);
  }
};

/// Supplies simulated or recorded drives. Implemented in experiments; called from many threads.
class DriveSource {
 public:
  virtual ~DriveSource() = default;
  /// The itinerary of all runs. If every run has its own drive, it is that of the drive with the
  /// most scans, without references, and has at least as many steps as every drive.
  virtual const Itinerary& itinerary() const = 0;
  /// Number of runs if every run is a different recorded drive, else 0.
  virtual std::size_t own_drives() const { return 0; }
  /// The itinerary of one run, with at most as many scans as itinerary() and the same landmarks.
  virtual const Itinerary& itinerary_of(std::uint64_t /*run*/) const { return itinerary(); }
  /// Writes the drive of one run, a pure function of (study, run), to `drive`.
  virtual void generate(std::uint64_t run, Drive& drive) const = 0;
};

}  // namespace montecarta::engine
