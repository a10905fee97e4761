// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/anchor.hpp"

#include "engine/errors.hpp"
#include "engine/numbers/angle.hpp"

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

/// The components that an anchor moves.
std::vector<Eigen::Index> moved_components(Anchor anchor, const StateShape& shape) {
  if (shape.kind == StateKind::pose) {
    if (anchor == Anchor::first) return {0, 1};
    return {0, 1, 2};
  }
  if (anchor == Anchor::first) return {0, 1, 2};
  if (anchor == Anchor::yaw) return {0, 1, 2, 5};
  return {0, 1, 2, 3, 4, 5};
}

}  // namespace

Anchor anchor_named(const std::string& name) {
  const auto found = std::ranges::find(kAnchors, name, &NamedAnchor::name);
  expect(found != kAnchors.end(), "an anchor has one of the names that the option takes");
  return found->anchor;
}

std::string name_of(Anchor anchor) { return named(anchor).name; }

std::string moved_by(Anchor anchor) { return named(anchor).moved; }

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

double share_at_anchor(Anchor anchor, const StateRows& estimates, std::size_t row) {
  constexpr double kLeastVariance = 1e-12;
  double most = 0.0;
  for (const Eigen::Index i : moved_components(anchor, estimates.shape)) {
    const double first = estimates.covariance[row](i, i);
    const double last = estimates.covariance.back()(i, i);
    if (first > kLeastVariance && last > 0.0) most = std::max(most, first / last);
  }
  return most;
}

}  // namespace montecarta::experiments
