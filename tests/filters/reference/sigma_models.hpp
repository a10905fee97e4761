// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/eigen_jacobians.hpp"
#include "tests/filters/reference/gaussian.hpp"
#include "tests/filters/reference/particle.hpp"
#include "tests/filters/reference/unscented.hpp"

/// The models as functions of stacked vectors, and the coordinates in which the filters' square
/// roots are triangular.
namespace montecarta::filters::reference {

/// f of (pose, control noise, sensor noise); the last has no effect.
struct MotionModel {
  Control control;
  double duration;
  Vehicle vehicle;
  Vector<3> operator()(const Vector<7>& x) const {
    const Pose from{x(0), x(1), x(2)};
    return to_vector(move(from, Control{control[0] + x(3), control[1] + x(4)}, duration, vehicle));
  }
};

/// h of (pose, landmark, sensor noise).
struct ObservationModel {
  Vector<2> operator()(const Vector<7>& x) const {
    const auto observation = predicted_observation(Pose{x(0), x(1), x(2)}, Point{x(3), x(4)});
    return {observation.range + x(5), wrap(observation.bearing + x(6))};
  }
};

/// h of a landmark seen from `pose`.
struct LandmarkModel {
  Pose pose;
  Vector<2> operator()(const Vector<2>& f) const {
    return filters::to_vector(predicted_observation(pose, Point{f(0), f(1)}));
  }
};

/// g of (range, bearing) seen from `pose`.
struct PlaceModel {
  Pose pose;
  Vector<2> operator()(const Vector<2>& z) const {
    const double angle = pose.heading + z(1);
    return {pose.x + z(0) * std::cos(angle), pose.y + z(0) * std::sin(angle)};
  }
};

/// Coordinates (heading, x, y).
inline Eigen::Matrix3d heading_first() {
  return Eigen::Matrix3d{{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
}
/// Coordinates (across, along) the line of sight from `pose` to `landmark`.
inline Eigen::Matrix2d across_first(const Vector<3>& pose, const Vector<2>& landmark) {
  const Vector<2> u = (landmark - pose.head<2>()).normalized();
  return Eigen::Matrix2d{{-u(1), u(0)}, {u(0), u(1)}};
}
/// Coordinates (across, along, heading).
inline Eigen::Matrix3d across_first_with_heading(const Vector<3>& pose, const Vector<2>& landmark) {
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  T.topLeftCorner<2, 2>() = across_first(pose, landmark);
  return T;
}

/// Square roots along the diagonal.
template <int A, int B, int C>
Eigen::Matrix<double, A + B + C, A + B + C> blocks(const Eigen::Matrix<double, A, A>& a,
                                                   const Eigen::Matrix<double, B, B>& b,
                                                   const Eigen::Matrix<double, C, C>& c) {
  Eigen::Matrix<double, A + B + C, A + B + C> S;
  S.setZero();
  S.template topLeftCorner<A, A>() = a;
  S.template block<B, B>(A, A) = b;
  S.template bottomRightCorner<C, C>() = c;
  return S;
}

/// Whether a bearing can be told (EQUATIONS 2).
inline bool is_far_enough(const Vector<3>& pose, const Landmark& landmark) {
  return (landmark.mean - pose.head<2>()).norm() >= kLeastDistance;
}

}  // namespace montecarta::filters::reference
