// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_setup.hpp"

namespace montecarta::filters {

/// What a sensor's noise is believed to be: variances of the components of its detections, named
/// after those of range [m^2] and bearing [rad^2]; 1 of a component that it does not have.
struct SensorNoise {
  double range;
  double bearing;

  static SensorNoise of(const Belief& belief) {
    const Eigen::Vector2d sigma = deviations_of(belief.sensor, belief);
    return {sigma(0) * sigma(0), sigma(1) * sigma(1)};
  }
};

}  // namespace montecarta::filters
