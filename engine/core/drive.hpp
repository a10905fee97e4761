// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace montecarta::engine {

/// What the filter is told about the motion of one step. How many components it has and what they
/// mean the vehicle says (EQUATIONS 1); those it does not have are 0.
struct Control {
  static constexpr std::size_t kMost = 3;  ///< components
  std::array<double, kMost> values{};

  double operator[](std::size_t i) const { return values[i]; }
  double& operator[](std::size_t i) { return values[i]; }
  /// A vehicle that stands does not move, whatever noise its motion has (EQUATIONS 1): no
  /// prediction. `moving`: how many of the first components are all 0 then.
  bool stands(std::size_t moving) const {
    return std::all_of(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(moving),
                       [](double value) { return value == 0.0; });
  }
};

/// One measurement of a landmark. How many components it has and what they mean the sensor says
/// (EQUATIONS 2); those it does not have are 0.
struct Detection {
  static constexpr std::size_t kMost = 2;            ///< components
  static constexpr std::int32_t kClutter = -1;       ///< identity of a false alarm
  static constexpr std::int32_t kUnidentified = -2;  ///< identity that nobody knows
  std::array<double, kMost> values{};                ///< e.g. range [m], bearing [rad]
  std::int32_t identity =
      kClutter;  ///< landmark of the world; a filter may estimate by it only with known association

  double operator[](std::size_t i) const { return values[i]; }
  double& operator[](std::size_t i) { return values[i]; }
};

/// All detections of one instant, no identity twice but clutter and the unidentified; may be empty.
using Scan = std::span<const Detection>;

/// An independent measurement of the vehicle's path, by which a recorded drive is judged.
struct ReferencePath {
  std::string name;                       ///< e.g. "gps"
  std::vector<double> time;               ///< [s] of each fix, increasing
  std::vector<Eigen::Vector2d> position;  ///< [m] of each fix
  std::vector<double> heading;            ///< [rad] of each fix; empty where it is not measured
  /// (m, m, rad)^2 of the error of each fix; without headings only the block of the position
  /// counts. Empty where nobody knows it.
  std::vector<Eigen::Matrix3d> covariance = {};

  /// Components that a fix measures: x, y and, where there are headings, the heading.
  int dimension() const { return heading.empty() ? 2 : 3; }
};

/// What all runs of a study share: when steps and scans happen and what there is to map.
struct Itinerary {
  std::vector<double> step_time;  ///< [s] at the end of each control step, one per step
  std::vector<std::uint32_t>
      scan_step;  ///< for each scan the index of the step after which it is taken
  std::vector<Eigen::Vector2d> landmarks;  ///< [m] true positions, by identity; empty where unknown
  std::vector<Eigen::Vector2d> waypoints;  ///< [m] for figures only; may be empty
  Pose start;  ///< pose before the first step, known to the filter exactly
  std::vector<ReferencePath> references;  ///< of a recorded drive
  std::size_t moving_controls = 1;        ///< a vehicle stands where so many first components are 0
  bool has_truth = true;  ///< whether drives carry the true poses; a recorded one does not

  std::size_t steps() const { return step_time.size(); }
  std::size_t scans() const { return scan_step.size(); }
  /// Length of step k [s].
  double duration(std::size_t k) const {
    return k == 0 ? step_time[0] : step_time[k] - step_time[k - 1];
  }
};

/// One run's input and the truth it is judged by. Buffers keep their memory from run to run.
struct Drive {
  std::vector<Control> controls;          ///< one per step, as given to the filter
  std::vector<Pose> truth;                ///< one per step, after the step; empty where unknown
  std::vector<Detection> detections;      ///< of all scans, one after the other
  std::vector<std::uint32_t> scan_begin;  ///< scans() + 1 offsets into `detections`

  Scan scan(std::size_t s) const {
    return Scan(detections).subspan(scan_begin[s], scan_begin[s + 1] - scan_begin[s]);
  }
};

/// Supplies drives: simulated or recorded. Implemented in experiments; called from many threads.
class DriveSource {
 public:
  virtual ~DriveSource() = default;
  /// Common to all runs; where every run is a drive of its own, that of the one with most scans,
  /// without references.
  virtual const Itinerary& itinerary() const = 0;
  /// How many runs there are, where every run is a recorded drive of its own; else 0.
  virtual std::size_t own_drives() const { return 0; }
  /// Of one run: it has at most as many scans as itinerary(), and the same landmarks.
  virtual const Itinerary& itinerary_of(std::uint64_t /*run*/) const { return itinerary(); }
  /// Fills `drive` for one run: a pure function of (study, run), whatever `drive` held before.
  virtual void generate(std::uint64_t run, Drive& drive) const = 0;
};

}  // namespace montecarta::engine
