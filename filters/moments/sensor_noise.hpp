// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_setup.hpp"

namespace montecarta::filters {

/// What a sensor's noise is believed to be: variances of range [m^2] and bearing [rad^2].
struct SensorNoise {
  double range;
  double bearing;

  static SensorNoise of(const Belief& belief) {
    return {belief.sigma_range * belief.sigma_range, belief.sigma_bearing * belief.sigma_bearing};
  }
};

}  // namespace montecarta::filters
