// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/random/stream.hpp"
#include "experiments/drives/scenario.hpp"
#include "filters/models/field_of_view.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
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

}  // namespace montecarta::experiments
