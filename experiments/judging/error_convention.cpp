// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/error_convention.hpp"

#include "engine/errors.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/records/columns.hpp"
#include "filters/joint/retraction.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <array>
#include <cmath>

namespace montecarta::experiments {
namespace {

using Convention = ErrorConvention;

constexpr std::array kConventions = {Convention::world, Convention::body,
                                     Convention::right_invariant};
static_assert(kConventions.size() == kErrorConventions.size(), "all are stored, in this order");
constexpr double kSmallTurn = 1e-5;  // [rad] below this, series of second order are exact

const StoredConvention& stored(Convention convention) {
  return kErrorConventions.at(static_cast<std::size_t>(convention));
}

Eigen::Vector3d pose_error(Convention convention, const Eigen::Vector3d& mean,
                           const Eigen::Vector3d& truth) {
  Eigen::Vector3d error = mean - truth;
  error(2) = wrap(error(2));
  if (convention == Convention::body) {
    error.head<2>() = Eigen::Rotation2Dd(-mean(2)) * Eigen::Vector2d(error.head<2>());
  } else if (convention == Convention::right_invariant) {  // mean = exp(error) truth
    const Eigen::Vector2d turned = Eigen::Rotation2Dd(error(2)) * Eigen::Vector2d(truth.head<2>());
    const Eigen::Vector2d shift = mean.head<2>() - turned;
    error.head<2>() = filters::exponential_jacobian(error(2)).partialPivLu().solve(shift);
  }
  return error;
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  return Eigen::Matrix3d{{0.0, -v.z(), v.y()}, {v.z(), 0.0, -v.x()}, {-v.y(), v.x(), 0.0}};
}

/// The axis of a rotation times its angle, which is at most pi.
Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const double sine = rotation.vec().norm();
  const double half = std::atan2(sine, sign * rotation.w());
  const double factor = sine < kSmallTurn ? 2.0 : 2.0 * half / sine;
  return sign * factor * rotation.vec();
}

/// The matrix V of the exponential of SE(3): exp(turn, rho) = (R(turn), V(turn) rho).
Eigen::Matrix3d exponential_jacobian_in_space(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  const Eigen::Matrix3d cross = cross_matrix(turn);
  if (angle < kSmallTurn) return Eigen::Matrix3d::Identity() + 0.5 * cross;
  const double a = (1.0 - std::cos(angle)) / (angle * angle);
  const double b = (angle - std::sin(angle)) / (angle * angle * angle);
  return Eigen::Matrix3d::Identity() + a * cross + b * cross * cross;
}

Eigen::VectorXd pose_error_in_space(Convention convention, const Eigen::VectorXd& mean,
                                    const Eigen::VectorXd& truth) {
  const Eigen::Quaterniond of_mean(Eigen::Vector4d(mean.tail<4>()));
  const Eigen::Quaterniond of_truth(Eigen::Vector4d(truth.tail<4>()));
  const Eigen::Vector3d p = mean.head<3>(), true_p = truth.head<3>();
  Eigen::VectorXd error(6);
  if (convention == Convention::body) {
    error << of_mean.conjugate() * (p - true_p), rotation_vector(of_truth.conjugate() * of_mean);
    return error;
  }
  const Eigen::Quaterniond turned = of_mean * of_truth.conjugate();
  const Eigen::Vector3d turn = rotation_vector(turned);
  if (convention == Convention::world) {
    error << p - true_p, turn;
    return error;
  }
  const Eigen::Vector3d shift = p - turned * true_p;  // mean = exp(error) truth
  error << exponential_jacobian_in_space(turn).partialPivLu().solve(shift), turn;
  return error;
}

Eigen::VectorXd vector_error(const StateShape& shape, const Eigen::VectorXd& mean,
                             const Eigen::VectorXd& truth) {
  Eigen::VectorXd error = mean - truth;
  for (std::size_t k = 0; k < shape.units.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (shape.units[k] == "rad") error(i) = wrap(error(i));
  }
  return error;
}

}  // namespace

std::string name_of(Convention convention) { return stored(convention).name; }

std::string nees_column(Convention convention) { return stored(convention).column; }

std::span<const Convention> conventions_of(StateKind kind) {
  return std::span(kConventions).first(kind == StateKind::vector ? 1 : kConventions.size());
}

Eigen::VectorXd error_of(const StateShape& shape, Convention convention,
                         const Eigen::VectorXd& mean, const Eigen::VectorXd& truth) {
  switch (shape.kind) {
    case StateKind::pose:
      return pose_error(convention, mean, truth);
    case StateKind::pose_in_space:
      return pose_error_in_space(convention, mean, truth);
    case StateKind::vector:
      break;
  }
  expect(convention == Convention::world, "a vector has no frame of its own");
  return vector_error(shape, mean, truth);
}

Eigen::Matrix3d covariance_in_map(Convention convention, const Eigen::Vector3d& mean,
                                  const Eigen::Matrix3d& covariance) {
  if (convention == Convention::world) return covariance;
  Eigen::Matrix3d map_from_error = Eigen::Matrix3d::Identity();
  if (convention == Convention::body) {
    map_from_error.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(mean(2)).toRotationMatrix();
  } else {  // EQUATIONS (15.3)
    map_from_error.topRightCorner<2, 1>() = filters::quarter_turn() * mean.head<2>();
  }
  return map_from_error * covariance * map_from_error.transpose();
}

}  // namespace montecarta::experiments
