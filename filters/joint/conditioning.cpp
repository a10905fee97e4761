// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_gaussian.hpp"

#include <cmath>
#include <utility>

// How a detection or a draw changes a JointGaussian.

namespace montecarta::filters {
namespace {

/// An iterated detection is settled when the innovation changes by less than this, in its own
/// standard deviations.
constexpr double kConverged = 1e-4;

/// L^-T; of the triangular factor, two divisions: S itself is never inverted.
Eigen::Matrix2d inverse_transposed(const InnovationFactor& L) {
  Eigen::Matrix2d inverse;
  inverse << 1.0 / L.l00, -L.l10 / (L.l00 * L.l11), 0.0, 1.0 / L.l11;
  return inverse;
}

}  // namespace

/// The step that the detection makes the pose and its landmark take, before any retraction: P H'
/// S^-1 v.
JointGaussian::Step JointGaussian::step_of(std::size_t slot, const ExpectedObservation& expected,
                                           const Eigen::Vector2d& innovation) const {
  const Eigen::Index row = row_of(slot);
  const Eigen::Vector2d weighed =
      inverse_transposed(expected.factor) * expected.factor.whiten(innovation);
  const Eigen::Vector3d pose = expected.pose_jacobian.transpose() * weighed;
  const Eigen::Vector2d landmark = expected.landmark_jacobian.transpose() * weighed;
  const auto mixed = map_.cross.middleRows<2>(row);
  return {pose_.covariance * pose + mixed.transpose() * landmark,
          mixed * pose + map_.covariance.block<2, 2>(row, row) * landmark};
}

/// Linearises anew where `step` leads; the Gaussian still belongs to the present estimate.
JointGaussian::Trouble JointGaussian::linearise_after(const Step& step, std::size_t slot,
                                                      ExpectedObservation& expected) const {
  const Eigen::Index row = row_of(slot);
  Eigen::Vector2d pose_way = step.pose.head<2>(), landmark_way = step.landmark;
  if (retraction_ == Retraction::invariant) {
    const Eigen::Matrix2d V = exponential_jacobian(step.pose(2));
    pose_way = V * pose_way;
    landmark_way = V * landmark_way;
  }
  const Pose& from = pose_.mean;
  const auto at = linearised_detection(
      belief_.sensor, Pose{from.x + pose_way(0), from.y + pose_way(1), from.heading + step.pose(2)},
      Point{map_.mean(row) + landmark_way(0), map_.mean(row + 1) + landmark_way(1)});
  if (!at) return Trouble::too_near;
  ExpectedObservation next{.pose_jacobian = at->by_pose,
                           .landmark_jacobian = at->by_landmark,
                           .observation = at->value,
                           .factor = {},
                           .ahead = {},
                           .wraps = wraps_};
  if (retraction_ == Retraction::invariant) {  // the error at the estimate before
    next.pose_jacobian.col(2) += next.pose_jacobian.leftCols<2>() * quarter_turned(pose_way) +
                                 next.landmark_jacobian * quarter_turned(landmark_way);
  }
  if (const auto trouble = weigh(point(slot), Eigen::Matrix2d::Zero(), next);
      trouble != Trouble::none)
    return trouble;
  next.ahead = next.pose_jacobian * step.pose + next.landmark_jacobian * step.landmark;
  expected = next;
  return Trouble::none;
}

JointGaussian::Trouble JointGaussian::update_with(std::size_t slot, const Eigen::Vector2d& detected,
                                                  int iterations, ExpectedObservation& expected) {
  Eigen::Vector2d innovation = expected.innovation(detected);
  Trouble trouble = Trouble::none;
  for (int i = 0; i < iterations; ++i) {
    trouble = linearise_after(step_of(slot, expected, innovation), slot, expected);
    if (trouble != Trouble::none) break;
    const Eigen::Vector2d before = std::exchange(innovation, expected.innovation(detected));
    if (expected.factor.whiten(innovation - before).norm() < kConverged) break;
  }
  whiten_gain(slot, expected);
  condition(expected.factor.whiten(innovation));
  return trouble;
}

/// W = P H' L^-T.
void JointGaussian::whiten_gain(std::size_t slot, const ExpectedObservation& expected) {
  const Eigen::Matrix2d inverse = inverse_transposed(expected.factor);
  const Matrix32 pose_white = expected.pose_jacobian.transpose() * inverse;
  const Eigen::Matrix2d landmark_white = expected.landmark_jacobian.transpose() * inverse;
  const Eigen::Index row = row_of(slot);
  copy_columns(map_.covariance, row, rows(), seen_);
  gain_pose_ =
      pose_.covariance * pose_white + map_.cross.middleRows<2>(row).transpose() * landmark_white;
  auto gain = gain_map_.leftCols<2>().topRows(rows());
  gain.noalias() = map_.cross.topRows(rows()).lazyProduct(pose_white);
  gain.noalias() += seen_.topRows(rows()).lazyProduct(landmark_white);
}

/// m <- m + W white, P <- P - W W', and the error carried along.
void JointGaussian::condition(const Eigen::Vector2d& white) {
  pose_.covariance -= gain_pose_ * gain_pose_.transpose();
  mirror_lower(pose_.covariance);
  const auto first = gain_map_.col(0).head(rows());
  const auto second = gain_map_.col(1).head(rows());
  for (Eigen::Index j = 0; j < 3; ++j) {
    map_.cross.col(j).head(rows()) -= first * gain_pose_(j, 0) + second * gain_pose_(j, 1);
  }
  const Eigen::Vector2d pose_step = step(white);
  change_map(retraction_ == Retraction::invariant && carry_error(pose_step));
}

/// Moves the estimate; returns how far the vehicle's place moved.
Eigen::Vector2d JointGaussian::step(const Eigen::Vector2d& white) {
  const Eigen::Vector3d pose_step = gain_pose_ * white;
  Eigen::Vector2d moved = pose_step.head<2>();
  auto map_step = map_step_.reshaped().head(rows());
  map_step = gain_map_.leftCols<2>().topRows(rows()).lazyProduct(white);
  if (retraction_ == Retraction::invariant) {
    const Eigen::Matrix2d V = exponential_jacobian(pose_step(2));
    moved = V * moved;
    apply(V, map_step_.leftCols(rows() / 2));
  }
  pose_.mean = {pose_.mean.x + moved(0), pose_.mean.y + moved(1),
                wrap(pose_.mean.heading + pose_step(2))};
  map_.mean.head(rows()) += map_step;
  return moved;
}

/// P <- T P T', T = I + d e_heading' with d = J step: the covariance, in the map frame, of an
/// invariant error that stayed while the estimate moved by `pose_step` and map_step_. Of the
/// landmarks' share, P + d c' + c d' + d h d' with c and h the covariances with the heading, it
/// leaves two squares for change_map(), which are exactly symmetric: P - b b' + a a' with b = c /
/// sqrt(h), a = b + sqrt(h) d. Neither is larger than P, so nothing cancels. False where the
/// heading is certain and nothing is to be done.
bool JointGaussian::carry_error(const Eigen::Vector2d& pose_step) {
  const double variance = pose_.covariance(2, 2);
  if (!(variance > 0.0)) return false;
  const double sigma = std::sqrt(variance);
  const Eigen::Vector2d d = quarter_turned(pose_step);
  apply(quarter_turn(), map_step_.leftCols(rows() / 2));
  const auto map_d = map_step_.reshaped().head(rows());
  const Eigen::Vector3d heading_row = pose_.covariance.row(2).transpose();
  gain_map_.col(2).head(rows()) = map_.cross.col(2).head(rows()) / sigma;
  gain_map_.col(3).head(rows()) = gain_map_.col(2).head(rows()) + sigma * map_d;
  auto cross = map_.cross.topRows(rows());
  cross += map_d.lazyProduct(heading_row.transpose());
  cross.col(0) += d(0) * cross.col(2);
  cross.col(1) += d(1) * cross.col(2);
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  T.topRightCorner<2, 1>() = d;
  pose_.covariance = (T * pose_.covariance * T.transpose()).eval();
  mirror_lower(pose_.covariance);
  return true;
}

/// With D the derivative of the points by the pose and C their covariance with it, P <- P - D C' -
/// C D' + D P_x D' = P - D G' - G D' with G = C - D P_x / 2.
void JointGaussian::centre_on_pose() {
  auto D = moved_.topRows(rows()), G = halved_.topRows(rows());
  D.setZero();
  for (std::size_t slot = 0; slot < n_landmarks_; ++slot) {
    const Eigen::Index row = row_of(slot);
    D.middleRows<2>(row) << 1.0, 0.0, pose_.mean.y - map_.mean(row + 1), 0.0, 1.0,
        map_.mean(row) - pose_.mean.x;
  }
  G = map_.cross.topRows(rows());
  G -= D.lazyProduct(0.5 * pose_.covariance);
  for (Eigen::Index j = 0; j < row_of(n_landmarks_); ++j) {
    const Eigen::Index first = pack_of(j), count = rows() - first;
    map_.covariance.col(j).segment(first, count) -=
        D.middleRows(first, count).lazyProduct(G.row(j).transpose()) +
        G.middleRows(first, count).lazyProduct(D.row(j).transpose());
  }
  pose_.covariance.setZero();
  map_.cross.topRows(rows()).setZero();
}

/// The landmarks' covariance, in one pass: P <- P - W W' and, where the error was carried, - b b' +
/// a a'. Whole packs in one order: exactly symmetric.
void JointGaussian::change_map(bool carries_error) {
  for (Eigen::Index j = 0; j < row_of(n_landmarks_); ++j) {
    const Eigen::Index first = pack_of(j), count = rows() - first;
    const auto gain = gain_map_.middleRows(first, count);
    auto column = map_.covariance.col(j).segment(first, count);
    if (carries_error) {
      column += gain.col(3) * gain_map_(j, 3) - gain.col(2) * gain_map_(j, 2) -
                gain.col(0) * gain_map_(j, 0) - gain.col(1) * gain_map_(j, 1);
    } else {
      column -= gain.col(0) * gain_map_(j, 0) + gain.col(1) * gain_map_(j, 1);
    }
  }
}

}  // namespace montecarta::filters
