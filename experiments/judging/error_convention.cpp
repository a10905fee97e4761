// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/error_convention.hpp"

#include "engine/errors.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/records/columns.hpp"
#include "filters/joint/retraction.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

namespace montecarta::experiments {
namespace {

using Convention = ErrorConvention;

constexpr std::array kConventions = {Convention::world, Convention::body,
                                     Convention::right_invariant, Convention::left_invariant,
                                     Convention::world_body};
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
  } else if (convention == Convention::left_invariant) {  // mean = truth exp(error)
    const Eigen::Vector2d shift = Eigen::Rotation2Dd(-truth(2)) * Eigen::Vector2d(error.head<2>());
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

/// The errors of vectors in the map, of the position and the velocity, and of the rotation between
/// an estimate and the truth.
class ErrorsInSpace {
 public:
  ErrorsInSpace(Convention convention, const Eigen::VectorXd& mean, const Eigen::VectorXd& truth)
      : convention_(convention),
        mean_(quaternion_in(mean)),
        truth_(quaternion_in(truth)),
        turned_(mean_ * truth_.conjugate()) {
    const bool is_in_map =
        convention == Convention::world || convention == Convention::right_invariant;
    rotation_ = rotation_vector(is_in_map ? turned_ : truth_.conjugate() * mean_);
  }

  const Eigen::Vector3d& of_rotation() const { return rotation_; }
  Eigen::Vector3d of_vector(const Eigen::Vector3d& mean, const Eigen::Vector3d& truth) const {
    if (convention_ == Convention::body) return mean_.conjugate() * (mean - truth);
    if (convention_ == Convention::right_invariant)  // mean = exp(error) truth
      return without_turn(mean - turned_ * truth);
    if (convention_ == Convention::left_invariant)  // mean = truth exp(error)
      return without_turn(truth_.conjugate() * (mean - truth));
    return mean - truth;
  }

 private:
  /// The part of the logarithm that belongs to a shift beside the rotation.
  Eigen::Vector3d without_turn(const Eigen::Vector3d& shift) const {
    return exponential_jacobian_in_space(rotation_).partialPivLu().solve(shift);
  }

  Convention convention_;
  Eigen::Quaterniond mean_, truth_, turned_;  ///< turned_: rotation from the truth to the estimate
  Eigen::Vector3d rotation_;
};

/// Writes mean - truth of the columns from `column` on to the components from `component` on,
/// wrapped if they are angles.
void put_differences(const StateShape& shape, const Eigen::VectorXd& mean,
                     const Eigen::VectorXd& truth, Eigen::Index column, Eigen::Index component,
                     Eigen::VectorXd& error) {
  for (; component < error.size(); ++column, ++component) {
    const double difference = mean(column) - truth(column);
    error(component) = is_angle(shape, column) ? wrap(difference) : difference;
  }
}

Eigen::VectorXd error_in_space(const StateShape& shape, Convention convention,
                               const Eigen::VectorXd& mean, const Eigen::VectorXd& truth) {
  const ErrorsInSpace errors(convention, mean, truth);
  Eigen::VectorXd error(static_cast<Eigen::Index>(shape.dimension()));
  error.head<3>() = errors.of_vector(mean.head<3>(), truth.head<3>());
  error.segment<3>(3) = errors.of_rotation();
  put_differences(shape, mean, truth, kPoseWidth, kPoseComponents, error);
  if (has_velocity(shape)) {
    error.segment<3>(kPoseComponents) =
        errors.of_vector(mean.segment<3>(kPoseWidth), truth.segment<3>(kPoseWidth));
  }
  return error;
}

}  // namespace

std::string name_of(Convention convention) { return stored(convention).name; }

std::string nees_column(Convention convention) { return stored(convention).column; }

std::span<const Convention> conventions_of(StateKind kind) {
  if (kind == StateKind::pose_in_space) return kConventions;
  return std::span(kConventions).first(kind == StateKind::vector ? 1 : kConventionsInPlane);
}

ErrorConvention stated_error(const StateShape& shape, const std::filesystem::path& path,
                             std::optional<ErrorConvention> said) {
  const auto known = conventions_of(shape.kind);
  const std::string likeness = likeness_to_pose(shape);
  if (!said && known.size() == 1 && likeness.empty()) return known.front();
  if (!said && known.size() == 1) {
    throw StudyError(
        "judge: --error is missing ({} is judged as a vector, mean - truth: {}): give --error "
        "world if it is a vector",
        path, likeness);
  }
  if (!said) {
    throw StudyError(
        "judge: --error is missing (the verdict depends on the error that the covariance "
        "describes): give --error world, body, right-invariant, left-invariant or, in space, "
        "world-body, which montecarta judge --help explains");
  }
  if (std::ranges::find(known, *said) != known.end()) return *said;
  if (known.size() > 1) return ErrorConvention::world;  // in the plane, world-body is world
  throw StudyError(
      "--error {}: not of a vector ({} has no pose, and only poses have frames{}): name the "
      "columns of the pose, or judge the error mean - truth of the vector by --error world",
      name_of(*said), path, likeness.empty() ? "" : "; " + likeness);
}

Eigen::VectorXd error_of(const StateShape& shape, Convention convention,
                         const Eigen::VectorXd& mean, const Eigen::VectorXd& truth) {
  switch (shape.kind) {
    case StateKind::pose:
      return pose_error(convention, mean, truth);
    case StateKind::pose_in_space:
      return error_in_space(shape, convention, mean, truth);
    case StateKind::vector:
      break;
  }
  expect(convention == Convention::world, "a vector has no frame of its own");
  Eigen::VectorXd error(mean.size());
  put_differences(shape, mean, truth, 0, 0, error);
  return error;
}

Eigen::Matrix3d covariance_in_map(Convention convention, const Eigen::Vector3d& mean,
                                  const Eigen::Matrix3d& covariance) {
  if (convention == Convention::world) return covariance;
  Eigen::Matrix3d map_from_error = Eigen::Matrix3d::Identity();
  if (convention == Convention::body || convention == Convention::left_invariant) {
    map_from_error.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(mean(2)).toRotationMatrix();
  } else {  // EQUATIONS (15.3)
    map_from_error.topRightCorner<2, 1>() = filters::quarter_turn() * mean.head<2>();
  }
  return map_from_error * covariance * map_from_error.transpose();
}

}  // namespace montecarta::experiments
