// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/map_moments.hpp"
#include "filters/setup/filter_setup.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace montecarta::filters {

/// The move of the estimate by a Kalman step, which defines the error that has the covariance.
enum class Retraction {
  additive,         ///< EKF-SLAM: truth = estimate + error
  right_invariant,  ///< RI-EKF-SLAM: truth = exp(error) estimate, moves pose and map together
  left_invariant    ///< truth = estimate exp(error), an error in the axes of the vehicle
};

/// V of the exponential of SE(2), Barrau sec. III: exp(turn, rho) = (R(turn), V(turn) rho). For a
/// step e, additive errors move a point by e and invariant errors by V e, since V J = R - I.
inline Eigen::Matrix2d exponential_jacobian(double turn) {
  const double half = 0.5 * turn;
  const double half_sine = std::sin(half);
  const bool small = std::abs(half) < 1e-4;  // there sin(half) / half = 1 - half^2 / 6 to 1e-17
  const double chord = small ? 1.0 - half * half / 6.0 : half_sine / half;
  const double along = chord * std::cos(half);  // sin(turn) / turn
  const double across = chord * half_sine;      // (1 - cos(turn)) / turn
  Eigen::Matrix2d V;
  V << along, -across, across, along;
  return V;
}

/// R, the rotation by `angle`.
inline Eigen::Matrix2d rotation_by(double angle) {
  return Eigen::Rotation2Dd(angle).toRotationMatrix();
}

/// J, the rotation by 90 degrees; J p is the displacement of p per rad of a rotation of the plane.
inline Eigen::Matrix2d quarter_turn() { return Eigen::Matrix2d{{0.0, -1.0}, {1.0, 0.0}}; }

/// Returns J p.
inline Eigen::Vector2d quarter_turned(const Eigen::Vector2d& p) { return {-p.y(), p.x()}; }

/// Multiplies every column by A.
inline void apply(const Eigen::Matrix2d& A, Eigen::Ref<Eigen::Matrix2Xd> vectors) {
  for (auto vector : vectors.colwise()) vector = (A * vector).eval();
}

/// The mean and covariance that a joint Gaussian reports (option `moments`).
enum class Moments {
  map,    ///< moments of the Gaussian in map coordinates
  pushed  ///< moments in map coordinates of a Gaussian in the right-invariant chart (EQUATIONS 19)
};

/// The option `moments` of a filter.
Parameter moments_option(const char* fallback);
Moments moments_of(const FilterOptions& options);

/// Takes `mean` and `covariance` for those of the right-invariant error about the estimate, truth =
/// exp(error) estimate, and replaces them by those in map coordinates (EQUATIONS (19.3), (19.4)).
/// Rows are x, y, heading [m, m, rad], then x and y of any number of landmarks [m]. Points rotate
/// with the heading, the only nonlinear component. NaN of landmarks never observed stays NaN.
void push_moments(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance);

/// These functions do the same for a pose, and for one point of a map with the given variance
/// [rad^2] of the heading.
PoseMoments pushed(const PoseMoments& pose);
LandmarkEstimate pushed(const PointMoments& point, double heading_variance);

}  // namespace montecarta::filters
