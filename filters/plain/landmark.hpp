// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/plain/gaussian.hpp"
#include "filters/setup/filter_setup.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::filters::plain {

/// One landmark of a map. A map lists its landmarks in the order of their initialisation.
struct Landmark {
  Vector<2> mean;
  Matrix<2> covariance;
  Matrix<2> factor = Matrix<2>::Zero();  ///< only if the filter keeps square roots
  std::int32_t identity = 0;             ///< of the detection that initialised it
};
using Map = std::vector<Landmark>;

/// The map of a filter that is given these landmarks, {identity}.
inline Map known_map(std::span<const LandmarkEstimate> landmarks) {
  Map map;
  for (const auto& [mean, covariance] : landmarks) {
    map.push_back({.mean = mean,
                   .covariance = covariance,
                   .factor = psd_chol(covariance),
                   .identity = static_cast<std::int32_t>(map.size())});
  }
  return map;
}

/// R, the covariance of the noise of (range, bearing).
inline Matrix<2> observation_noise(const Belief& belief) {
  return Vector<2>(belief.sigma_range, belief.sigma_bearing).cwiseAbs2().asDiagonal();
}

/// Q, the covariance of the noise of the controls (EQUATIONS (1.10)).
inline Eigen::MatrixXd control_noise(const Belief& belief, const Control& control) {
  const auto sigma = deviations_of(belief.control, control, belief.vehicle);
  const auto n = static_cast<Eigen::Index>(controls_of(belief.vehicle).size());
  return Eigen::VectorXd::Map(sigma.data(), n).cwiseAbs2().asDiagonal();
}

/// The columns of a square root of the covariance that the noise of a step adds to a pose with this
/// heading, besides that of its controls (EQUATIONS (1.11), (1.12)).
inline Matrix<3> increment_root(const Belief& belief, double heading, const Control& u,
                                double duration) {
  Matrix<3> root = Matrix<3>::Zero();
  if (belief.control.increment.is_none()) return root;
  const auto step = body_step(belief.vehicle, u, duration);
  const auto columns = increment_columns(belief.control.increment, step, duration);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto& [forward, left, turn] = columns[static_cast<std::size_t>(k)];
    root.col(k) << Eigen::Rotation2D<double>(heading) * Vector<2>(forward, left), turn;
  }
  return root;
}
inline Matrix<3> increment_covariance(const Belief& belief, double heading, const Control& u,
                                      double duration) {
  const Matrix<3> root = increment_root(belief, heading, u, duration);
  return root * root.transpose();
}

/// (x, P) -> (f(x, u), Fx P Fx' + Fu Q Fu' + noise of the step) (EQUATIONS (1.3), (1.4)).
inline void move_linearised(Vector<3>& x, Matrix<3>& P, const Control& u, double duration,
                            const Belief& belief) {
  const auto step = linearised_move(as_pose(x), u, duration, belief.vehicle);
  const Matrix<3> Fx = pose_jacobian(step.jacobians);
  const ControlJacobian Fu = control_jacobian(step.jacobians);
  P = (Fx * P * Fx.transpose() + Fu * control_noise(belief, u) * Fu.transpose() +
       increment_covariance(belief, x(2), u, duration))
          .eval();
  x = to_vector(step.pose);
}

inline Vector<2> vector_of(const Detection& z) { return {z[0], z[1]}; }

/// z - h, with the bearing wrapped.
inline Vector<2> difference(const Detection& z, const Vector<2>& h) {
  return {z[0] - h(0), wrap(z[1] - h(1))};
}

/// The bearing has no derivative if the landmark is nearer than this (EQUATIONS 2).
inline bool is_far_enough(const Vector<3>& pose, const Vector<2>& landmark) {
  return (landmark - pose.head<2>()).norm() >= kLeastDistance;
}

/// The innovation of a landmark that is observed from a pose, with its derivatives (EQUATIONS 2).
struct LinearisedInnovation {
  Vector<2> nu;  ///< z - h(x, mu)
  Matrix23 Hx;   ///< of h by the pose
  Matrix<2> Hf;  ///< of h by the landmark
  Matrix<2> Sf;  ///< Hf Sigma Hf' + R, the covariance of nu if the pose is known
};

/// nullopt if the landmark is too near.
inline std::optional<LinearisedInnovation> innovation_at(const Vector<3>& pose,
                                                         const Landmark& landmark,
                                                         const Detection& z, const Matrix<2>& R) {
  if (!is_far_enough(pose, landmark.mean)) return std::nullopt;
  const auto at = linearised_observation(as_pose(pose), Point{landmark.mean(0), landmark.mean(1)});
  const Matrix<2> Hf = landmark_jacobian(at);
  return LinearisedInnovation{difference(z, to_vector(at.observation)), pose_jacobian(at), Hf,
                              Hf * landmark.covariance * Hf.transpose() + R};
}

/// Updates a landmark that is observed again from a known pose (EQUATIONS (4.3)).
inline void update_landmark(Landmark& landmark, const LinearisedInnovation& v, const Matrix<2>& R) {
  const Matrix<2> K = gain<2, 2>(landmark.covariance * v.Hf.transpose(), v.Sf);
  const Matrix<2> kept = Matrix<2>::Identity() - K * v.Hf;
  landmark.mean += K * v.nu;
  landmark.covariance =
      (kept * landmark.covariance * kept.transpose() + K * R * K.transpose()).eval();
}

/// Initialises a landmark that is observed from a known pose (EQUATIONS (4.4)).
inline Landmark new_landmark(const Vector<3>& pose, const Detection& z, const Matrix<2>& R) {
  const auto placed = linearised_place(as_pose(pose), observation_of(z));
  const Matrix<2> Gz = observation_jacobian(placed);
  return {.mean = to_vector(placed.point), .covariance = Gz * R * Gz.transpose()};
}

}  // namespace montecarta::filters::plain
