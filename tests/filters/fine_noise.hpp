// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/factory.hpp"

namespace montecarta::filters {

/// Noise so small that the models are linear within it: there EKF-SLAM is the Kalman filter of its
/// world.
inline Belief fine() {
  return {.vehicle = {},
          .control = {.sigma = {3e-3, 5e-4}},
          .sigma_range = 1e-3,
          .sigma_bearing = 2e-4};
}

}  // namespace montecarta::filters
