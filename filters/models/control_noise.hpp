// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/vehicle.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace montecarta::models {

/// The noise of the controls of a vehicle: independent, of the deviations `sigma`, and of `alpha`,
/// what they grow by with the control (EQUATIONS 1; Thrun 2005, table 5.3).
struct ControlNoise {
  std::array<double, Control::kMost> sigma{};  ///< of each component, in its unit
  /// Variance of each but the last component (speeds) by the square of those, and by the square of
  /// the last one (steering angle or yaw rate); variance of the last one likewise.
  std::array<double, 4> alpha{};

  bool grows() const {
    return std::ranges::any_of(alpha, [](double value) { return value != 0.0; });
  }
};

/// Standard deviation of each component of `control`, in its unit.
inline std::array<double, Control::kMost> deviations_of(const ControlNoise& noise,
                                                        const Control& control,
                                                        const Vehicle& vehicle) {
  std::array<double, Control::kMost> sigma = noise.sigma;
  if (!noise.grows()) return sigma;
  const std::size_t last = controls_of(vehicle).size() - 1;
  double speeds = 0.0;
  for (std::size_t i = 0; i < last; ++i) speeds += control[i] * control[i];
  const double turning = control[last] * control[last];
  for (std::size_t i = 0; i <= last; ++i) {
    const double* alpha = &noise.alpha[i == last ? 2 : 0];
    sigma[i] = std::sqrt(sigma[i] * sigma[i] + alpha[0] * speeds + alpha[1] * turning);
  }
  return sigma;
}

}  // namespace montecarta::models
