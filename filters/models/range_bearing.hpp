// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/numbers/real.hpp"

#include <cmath>

namespace montecarta::models {

/// A point in the map frame; `Real` is double or Lanes.
template <class Real>
struct BasicPoint {
  Real x{};  ///< [m]
  Real y{};  ///< [m]

  [[gnu::always_inline]] friend BasicPoint operator+(const BasicPoint& a, const BasicPoint& b) {
    return {a.x + b.x, a.y + b.y};
  }
  [[gnu::always_inline]] friend BasicPoint operator-(const BasicPoint& a, const BasicPoint& b) {
    return {a.x - b.x, a.y - b.y};
  }
};
using Point = BasicPoint<double>;

/// Range and bearing of a landmark from a pose, or the difference of two such observations.
template <class Real>
struct RangeBearing {
  Real range{};    ///< [m]
  Real bearing{};  ///< [rad] relative to the heading, in (-pi, pi]
};

/// The components that a sensor measures of a landmark, in the order of its detections, or the
/// difference of two such measurements. `second` is 0 if the sensor has one component.
template <class Real>
struct Measurement {
  Real first{};   ///< range, forward [m] or bearing [rad]
  Real second{};  ///< bearing [rad] or left [m]
};

/// The predicted observation with its derivatives (EQUATIONS 2). Hf = [range_x range_y; bearing_x
/// bearing_y] by the landmark; Hx = [-Hf, (0, -1)'] by the pose.
template <class Real>
struct LinearisedObservation {
  RangeBearing<Real> observation;
  Real range_x;    ///< [1]
  Real range_y;    ///< [1]
  Real bearing_x;  ///< [rad/m]
  Real bearing_y;  ///< [rad/m]
};

/// The position of a landmark by one detection, with derivatives (EQUATIONS 2). Gz = [x_range
/// x_bearing; y_range y_bearing] by the detection; Gx = [1 0 x_bearing; 0 1 y_bearing] by the pose.
template <class Real>
struct LinearisedPlace {
  BasicPoint<Real> point;
  Real x_range;    ///< [1]
  Real x_bearing;  ///< [m/rad]
  Real y_range;    ///< [1]
  Real y_bearing;  ///< [m/rad]
};

/// Distance [m] below which the bearing has no derivative; the caller must leave out the detection
/// (EQUATIONS 2).
inline constexpr double kLeastDistance = 1e-6;

/// h(x, f): the predicted observation of `landmark` from `pose`.
template <class Real>
RangeBearing<Real> predicted_observation(const BasicPose<Real>& pose,
                                         const BasicPoint<Real>& landmark) {
  using std::atan2;
  using std::sqrt;
  const Real dx = landmark.x - pose.x;
  const Real dy = landmark.y - pose.y;
  return {sqrt(Real(dx * dx + dy * dy)), wrap(Real(Real(atan2(dy, dx)) - pose.heading))};
}

/// h(x, f) with its derivatives, which are not valid if too_near().
template <class Real>
LinearisedObservation<Real> linearised_observation(const BasicPose<Real>& pose,
                                                   const BasicPoint<Real>& landmark) {
  const RangeBearing<Real> observation = predicted_observation(pose, landmark);
  const Real per_range = Real(1.0) / observation.range;
  const Real ux = (landmark.x - pose.x) * per_range;
  const Real uy = (landmark.y - pose.y) * per_range;
  return {observation, ux, uy, -(uy * per_range), ux * per_range};
}

/// Returns, for every lane, whether the landmark is too near for the derivatives.
template <class Real>
auto too_near(const RangeBearing<Real>& predicted) {
  return predicted.range < Real(kLeastDistance);
}

/// Innovation, detected minus predicted, with the bearing wrapped.
template <class Real>
RangeBearing<Real> residual(const RangeBearing<Real>& detected,
                            const RangeBearing<Real>& predicted) {
  return {detected.range - predicted.range, wrap(Real(detected.bearing - predicted.bearing))};
}

/// The measured values of a range-bearing detection.
inline RangeBearing<double> observation_of(const Detection& detection) {
  return {detection[0], detection[1]};
}

/// The measured values of a detection of any sensor, the same in all lanes.
template <class Real>
Measurement<Real> measurement_of(const Detection& detection) {
  return {Real(detection[0]), Real(detection[1])};
}

/// g(x, z): the position of a landmark that is observed so from `pose`, with derivatives.
template <class Real>
LinearisedPlace<Real> linearised_place(const BasicPose<Real>& pose,
                                       const RangeBearing<Real>& observation) {
  const Direction<Real> ray = direction_of(Real(pose.heading + observation.bearing));
  const Real along_x = observation.range * ray.cosine;
  const Real along_y = observation.range * ray.sine;
  return {{pose.x + along_x, pose.y + along_y}, ray.cosine, -along_y, ray.sine, along_x};
}

}  // namespace montecarta::models
