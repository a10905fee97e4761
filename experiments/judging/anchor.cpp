// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/anchor.hpp"

#include "engine/errors.hpp"
#include "engine/numbers/angle.hpp"
#include "experiments/judging/difference_bound.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace montecarta::experiments {
namespace {

struct NamedAnchor {
  Anchor anchor;
  const char* name;
  const char* moved;
};
constexpr std::array kAnchors = {NamedAnchor{Anchor::first, "first", "position"},
                                 NamedAnchor{Anchor::yaw, "yaw", "position and heading"},
                                 NamedAnchor{Anchor::se3, "se3", "position and rotation"}};

const NamedAnchor& named(Anchor anchor) { return kAnchors.at(static_cast<std::size_t>(anchor)); }

Eigen::Quaterniond rotation_of(const StateShape& shape, const Eigen::VectorXd& state) {
  if (shape.kind == StateKind::pose_in_space) return quaternion_in(state);
  return Eigen::Quaterniond(Eigen::AngleAxisd(state(2), Eigen::Vector3d::UnitZ()));
}

/// The rotation about the vertical that brings `turn` nearest to no rotation.
Eigen::Quaterniond about_vertical(const Eigen::Quaterniond& turn) {
  const double half = std::atan2(turn.z(), turn.w());
  return Eigen::Quaterniond(Eigen::AngleAxisd(2.0 * half, Eigen::Vector3d::UnitZ()));
}

/// A motion of the map: a rotation about the point `from`, which it moves to `to`.
struct Motion {
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  Eigen::Vector3d from, to;

  Eigen::VectorXd moved(const StateShape& shape, const Eigen::VectorXd& state) const {
    Eigen::VectorXd found = state;
    if (shape.kind == StateKind::pose) {
      const Eigen::Vector3d position =
          turn * (Eigen::Vector3d(state(0), state(1), 0.0) - from) + to;
      found << position.head<2>(), wrap(state(2) + 2.0 * std::atan2(turn.z(), turn.w()));
      return found;
    }
    found.head<3>() = turn * (state.head<3>() - from) + to;
    found.segment<4>(kQuaternionPlace) = (turn * rotation_of(shape, state)).coeffs();
    if (has_velocity(shape)) found.segment<3>(kPoseWidth) = turn * state.segment<3>(kPoseWidth);
    return found;
  }
};

Eigen::Vector3d position_of(const StateShape& shape, const Eigen::VectorXd& state) {
  if (shape.kind == StateKind::pose) return {state(0), state(1), 0.0};
  return state.head<3>();
}

Motion motion_to(Anchor anchor, const StateShape& shape, const Eigen::VectorXd& mean,
                 const Eigen::VectorXd& truth) {
  Motion motion{.from = position_of(shape, truth), .to = position_of(shape, mean)};
  if (anchor == Anchor::first) return motion;
  motion.turn = rotation_of(shape, mean) * rotation_of(shape, truth).conjugate();
  if (anchor == Anchor::yaw) motion.turn = about_vertical(motion.turn);
  return motion;
}

Eigen::Index pose_components(const StateShape& shape) {
  return shape.kind == StateKind::pose ? 3 : kPoseComponents;
}

/// The truth of the estimate `mean` if the error of its pose in the map (19.1) is `error`.
Eigen::VectorXd truth_for(const StateShape& shape, const Eigen::VectorXd& mean,
                          const Eigen::VectorXd& error) {
  Eigen::VectorXd truth = mean;
  if (shape.kind == StateKind::pose) {
    truth.head<3>() -= error;
    return truth;
  }
  const Eigen::Vector3d turn = error.segment<3>(3);
  truth.head<3>() -= error.head<3>();
  const Eigen::AngleAxisd back(-turn.norm(), turn.normalized());
  truth.segment<4>(kQuaternionPlace) =
      (Eigen::Quaterniond(back) * rotation_of(shape, mean)).coeffs();
  return truth;
}

/// The derivative of `f` at 0 of `n` numbers.
template <class Function>
Eigen::MatrixXd derivative(const Function& f, Eigen::Index n) {
  constexpr double kStep = 1e-4;  // [m, rad]
  Eigen::MatrixXd found;
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(n, k);
    const Eigen::VectorXd column = (f(step) - f(-step)) / (2.0 * kStep);
    if (found.size() == 0) found.resize(column.size(), n);
    found.col(k) = column;
  }
  return found;
}

}  // namespace

Anchor anchor_named(const std::string& name) {
  const auto found = std::ranges::find(kAnchors, name, &NamedAnchor::name);
  expect(found != kAnchors.end(), "an anchor has one of the names that the option takes");
  return found->anchor;
}

std::string name_of(Anchor anchor) { return named(anchor).name; }

std::string moved_by(Anchor anchor) { return named(anchor).moved; }

std::vector<Eigen::Index> moved_components(Anchor anchor, const StateShape& shape) {
  if (shape.kind == StateKind::pose) {
    if (anchor == Anchor::first) return {0, 1};
    return {0, 1, 2};
  }
  if (anchor == Anchor::first) return {0, 1, 2};
  if (anchor == Anchor::yaw) return {0, 1, 2, 5};
  return {0, 1, 2, 3, 4, 5};
}

std::optional<std::size_t> move_to_anchor(Anchor anchor, const StateRows& estimates,
                                          const std::filesystem::path& path,
                                          std::vector<std::optional<TrueState>>& truths) {
  const StateShape& shape = estimates.shape;
  if (shape.kind == StateKind::vector) {
    throw StudyError(
        "{}: --anchor {} is for poses (this state is a vector, which has no frame): leave it out",
        path, name_of(anchor));
  }
  const auto first = std::ranges::find_if(truths, [](const auto& one) { return one.has_value(); });
  if (first == truths.end()) return std::nullopt;
  const auto row = static_cast<std::size_t>(first - truths.begin());
  const Eigen::VectorXd& mean = estimates.state[row];
  const Motion motion = motion_to(anchor, shape, mean, (*first)->state);
  for (auto& truth : truths) {
    if (truth) truth->state = motion.moved(shape, truth->state);
  }
  first->reset();
  return row;
}

AnchorError::AnchorError(Anchor anchor, ErrorConvention convention, const StateRows& estimates,
                         std::size_t row)
    : anchor_(anchor), convention_(convention), estimates_(&estimates), row_(row) {
  constexpr double kLeastVariance = 1e-12;
  const StateShape& shape = estimates.shape;
  const Eigen::VectorXd& mean = estimates.state[row];
  const Eigen::Index n = pose_components(shape);
  covariance_ = estimates.covariance[row].topLeftCorner(n, n);
  if (!is_covariance(covariance_)) {  // a fault of the estimate; its size is all that is known
    covariance_ = Eigen::MatrixXd(covariance_.diagonal().cwiseAbs().asDiagonal());
  }
  const auto moved = moved_components(anchor, shape);
  if (std::ranges::all_of(moved,
                          [&](Eigen::Index i) { return covariance_(i, i) <= kLeastVariance; })) {
    covariance_.setZero();
    return;
  }
  const Eigen::MatrixXd from_map = derivative(
      [&](const Eigen::VectorXd& error) -> Eigen::VectorXd {
        return error_of(shape, convention, mean, truth_for(shape, mean, error)).head(n);
      },
      n);
  const auto factored = from_map.partialPivLu();
  covariance_ = factored.solve(factored.solve(covariance_).transpose());
}

Eigen::MatrixXd AnchorError::covariance_in(std::size_t row) const {
  const StateShape& shape = estimates_->shape;
  const Eigen::VectorXd &first = estimates_->state[row_], &mean = estimates_->state[row];
  const Eigen::MatrixXd carried = derivative(
      [&](const Eigen::VectorXd& error) {
        const Motion motion = motion_to(anchor_, shape, first, truth_for(shape, first, error));
        return error_of(shape, convention_, mean, motion.moved(shape, mean));
      },
      pose_components(shape));
  const Eigen::MatrixXd P = carried * covariance_ * carried.transpose();
  return 0.5 * (P + P.transpose());
}

}  // namespace montecarta::experiments
