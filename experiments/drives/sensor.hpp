// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/stream.hpp"
#include "engine/runs/drive.hpp"
#include "experiments/drives/scenario.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace montecarta {

/// A landmark in view, as a perfect sensor would see it.
struct Sight {
  std::int32_t identity = 0;
  double range = 0.0;    ///< [m]
  double bearing = 0.0;  ///< [rad]
};

/// Measured ranges are never below this [m], however large the noise (SPEC 3).
inline constexpr double kLeastRange = 1e-3;

/// The range-bearing sensor of SPEC 1.1 and 3.
class Sensor {
 public:
  explicit Sensor(const Scenario& scenario);

  /// Calls visit(sight) for everything in view from `pose`, in increasing identity.
  template <class Visit>
  void see(const Pose& pose, std::span<const Eigen::Vector2d> landmarks, const Visit& visit) const {
    const double cosine = std::cos(pose.heading);
    const double sine = std::sin(pose.heading);
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      const double dx = landmarks[i].x() - pose.x;
      const double dy = landmarks[i].y() - pose.y;
      const double squared = dx * dx + dy * dy;
      if (squared >= max_range_ * max_range_) continue;
      const double range = std::sqrt(squared);
      if (dx * cosine + dy * sine <= range * cos_half_view_) continue;
      visit(Sight{static_cast<std::int32_t>(i), range, wrap(std::atan2(dy, dx) - pose.heading)});
    }
  }

  /// Appends the detection of `sight`, with noise, unless it is missed. `place` names study seed,
  /// run and step; every landmark has its own numbers, so that what one sees shifts no other.
  void detect(const Sight& sight, const StreamIdentity& place,
              std::vector<Detection>& detections) const;
  /// Appends the false alarms of one scan, uniform over the area in view.
  void add_clutter(const StreamIdentity& place, std::vector<Detection>& detections) const;

 private:
  double max_range_;
  double field_of_view_;
  double cos_half_view_;
  double sigma_range_;
  double sigma_bearing_;
  double miss_probability_;
  double clutter_rate_;
};

}  // namespace montecarta
