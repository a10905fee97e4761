// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/joint_bound.hpp"

#include "filters/models/eigen_jacobians.hpp"

#include <Eigen/Cholesky>

#include <limits>

namespace montecarta::analysis {
namespace {

void mirror_lower(Eigen::Matrix3d& P) { P.triangularView<Eigen::StrictlyUpper>() = P.transpose(); }

}  // namespace

JointBound::JointBound(std::size_t landmarks, const Vehicle& vehicle,
                       const ControlNoise& control_noise,
                       const Eigen::Vector2d& observation_variance)
    : vehicle_(vehicle),
      control_noise_(control_noise),
      observation_variance_(observation_variance),
      row_(landmarks, 0) {
  const auto rows = 3 + 2 * static_cast<Eigen::Index>(landmarks);
  joint_.setZero(rows, rows);
}

/// P' = Fx P Fx' + Fu Q Fu'. The map waits for finish_motion(): Fx of several steps is again
/// [1 0 a; 0 1 b; 0 0 1] with a and b their sums.
Pose JointBound::move(const Pose& pose, const Control& control, double duration) {
  const auto step = linearised_move(pose, control, duration, vehicle_);
  const Eigen::Matrix3d F = pose_jacobian(step.jacobians);
  const auto sigma = deviations_of(control_noise_, control, vehicle_);
  ControlJacobian noise = control_jacobian(step.jacobians);
  for (Eigen::Index i = 0; i < noise.cols(); ++i)
    noise.col(i) *= sigma[static_cast<std::size_t>(i)];
  pose_ = F * pose_ * F.transpose() + noise * noise.transpose();
  mirror_lower(pose_);
  pending_x_heading_ += step.jacobians.x_heading;
  pending_y_heading_ += step.jacobians.y_heading;
  return step.pose;
}

void JointBound::finish_motion() {
  auto cross = joint_.block(3, 0, size_ - 3, 3);
  cross.col(0) += pending_x_heading_ * cross.col(2);
  cross.col(1) += pending_y_heading_ * cross.col(2);
  joint_.topLeftCorner<3, 3>() = pose_;
  pending_x_heading_ = pending_y_heading_ = 0.0;
}

bool JointBound::scan(const Pose& pose, std::span<const Seen> landmarks) {
  finish_motion();
  std::vector<Seen> known;
  for (const Seen& landmark : landmarks) {
    if (row_of(landmark.identity) != 0) known.push_back(landmark);
  }
  if (!known.empty() && !correct(pose, known)) return false;
  for (const Seen& landmark : landmarks) {
    if (row_of(landmark.identity) == 0) append(pose, landmark);
  }
  return pose_.allFinite();
}

Eigen::VectorXd JointBound::column(Eigen::Index j) const {
  Eigen::VectorXd column(size_);
  column.head(j) = joint_.row(j).head(j).transpose();
  column.tail(size_ - j) = joint_.col(j).segment(j, size_ - j);
  return column;
}

/// P <- P - P H' S^-1 H P for all observations of a scan at once, with S = L L' and W = P H' L^-T.
bool JointBound::correct(const Pose& pose, std::span<const Seen> landmarks) {
  const auto m = 2 * static_cast<Eigen::Index>(landmarks.size());
  Eigen::MatrixXd gain(size_, m);  // P H'
  Eigen::MatrixXd S(m, m);
  std::vector<LinearisedObservation<double>> observations;
  for (const Seen& landmark : landmarks) {
    const auto i = 2 * static_cast<Eigen::Index>(observations.size());
    const auto& observation =
        observations.emplace_back(linearised_observation(pose, landmark.point));
    const Eigen::Index row = row_of(landmark.identity);
    const Matrix23 Hx = pose_jacobian(observation);
    const Eigen::Matrix2d Hf = landmark_jacobian(observation);
    gain.middleCols<2>(i).noalias() = joint_.block(0, 0, size_, 3) * Hx.transpose();
    gain.middleCols<2>(i) += column(row) * Hf.col(0).transpose();
    gain.middleCols<2>(i) += column(row + 1) * Hf.col(1).transpose();
  }
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const auto i = 2 * static_cast<Eigen::Index>(k);
    S.middleRows<2>(i) =
        pose_jacobian(observations[k]) * gain.topRows<3>() +
        landmark_jacobian(observations[k]) * gain.middleRows<2>(row_of(landmarks[k].identity));
    S.diagonal().segment<2>(i) += observation_variance_;
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(S);
  if (factor.info() != Eigen::Success) return false;
  factor.matrixU().solveInPlace<Eigen::OnTheRight>(gain);
  joint_.topLeftCorner(size_, size_).selfadjointView<Eigen::Lower>().rankUpdate(gain, -1.0);
  pose_ = joint_.topLeftCorner<3, 3>();
  mirror_lower(pose_);
  joint_.topLeftCorner<3, 3>() = pose_;
  return true;
}

void JointBound::append(const Pose& pose, const Seen& landmark) {
  const auto placed = linearised_place(pose, predicted_observation(pose, landmark.point));
  const Matrix23 Gx = pose_jacobian(placed);
  const Eigen::Matrix2d Gz = observation_jacobian(placed);
  row_of(landmark.identity) = size_;
  joint_.block(size_, 0, 2, size_).noalias() = Gx * joint_.block(0, 0, size_, 3).transpose();
  joint_.block<2, 2>(size_, size_) =
      Gx * pose_ * Gx.transpose() + Gz * observation_variance_.asDiagonal() * Gz.transpose();
  size_ += 2;
}

double JointBound::mean_map_variance() const {
  if (size_ == 3) return std::numeric_limits<double>::quiet_NaN();
  return joint_.diagonal().segment(3, size_ - 3).sum() / static_cast<double>(seen());
}

Eigen::MatrixXd JointBound::covariance() const {
  Eigen::MatrixXd P = joint_.topLeftCorner(size_, size_).selfadjointView<Eigen::Lower>();
  P.topLeftCorner<3, 3>() = pose_;
  return P;
}

}  // namespace montecarta::analysis
