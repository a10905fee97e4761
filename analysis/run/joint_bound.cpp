// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/joint_bound.hpp"

#include "analysis/statistics/spread.hpp"
#include "filters/models/eigen_jacobians.hpp"

#include <Eigen/Cholesky>

namespace montecarta::analysis {
namespace {

/// [m] Initial standard deviation of a landmark that one detection does not fix: large enough to
/// add no information, and small enough to add no rounding errors.
constexpr double kUnknown = 1000.0;

void mirror_lower(Eigen::Matrix3d& P) { P.triangularView<Eigen::StrictlyUpper>() = P.transpose(); }

}  // namespace

JointBound::JointBound(std::size_t landmarks, const Vehicle& vehicle,
                       const ControlNoise& control_noise,
                       const Eigen::Vector2d& observation_variance, const Sensor& sensor)
    : vehicle_(vehicle),
      control_noise_(control_noise),
      observation_variance_(observation_variance),
      sensor_(sensor),
      row_(landmarks, 0) {
  const auto rows = 3 + 2 * static_cast<Eigen::Index>(landmarks);
  joint_.setZero(rows, rows);
}

void JointBound::start_from(const PriorDeviations& prior) {
  pose_ = prior.start_covariance();
  joint_.topLeftCorner<3, 3>() = pose_;
  for (Eigen::Index& row : row_) {
    row = size_;
    joint_.block<2, 2>(size_, size_) = prior.landmark_covariance();
    size_ += 2;
  }
}

/// P' = Fx P Fx' + Fu Q Fu'. The map is updated by finish_motion(): the product of Fx over several
/// steps is again [1 0 a; 0 1 b; 0 0 1], where a and b are sums over the steps.
Pose JointBound::move(const Pose& pose, const Control& control, double duration) {
  const auto step = linearised_move(pose, control, duration, vehicle_);
  const Eigen::Matrix3d F = pose_jacobian(step.jacobians);
  const auto sigma = deviations_of(control_noise_, control, vehicle_);
  ControlJacobian noise = control_jacobian(step.jacobians);
  for (Eigen::Index i = 0; i < noise.cols(); ++i)
    noise.col(i) *= sigma[static_cast<std::size_t>(i)];
  pose_ = F * pose_ * F.transpose() + noise * noise.transpose();
  add_increment_noise(pose, control, duration);
  mirror_lower(pose_);
  pending_x_heading_ += step.jacobians.x_heading;
  pending_y_heading_ += step.jacobians.y_heading;
  return step.pose;
}

/// Adds the noise of a step besides that of its controls (EQUATIONS (1.11), (1.12)).
void JointBound::add_increment_noise(const Pose& pose, const Control& control, double duration) {
  if (control_noise_.increment.is_none()) return;
  const auto step = body_step(vehicle_, control, duration);
  for (const auto& column : increment_columns(control_noise_.increment, step, duration)) {
    const Point way = in_world(direction_of(pose.heading), column.forward, column.left);
    const Eigen::Vector3d in_map(way.x, way.y, column.turn);
    pose_ += in_map * in_map.transpose();
  }
}

void JointBound::finish_motion() {
  auto cross = joint_.block(3, 0, size_ - 3, 3);
  cross.col(0) += pending_x_heading_ * cross.col(2);
  cross.col(1) += pending_y_heading_ * cross.col(2);
  joint_.topLeftCorner<3, 3>() = pose_;
  pending_x_heading_ = pending_y_heading_ = 0.0;
}

bool JointBound::scan(const Pose& pose, std::span<const SeenLandmark> landmarks) {
  finish_motion();
  if (!fixes_landmark(sensor_)) {
    for (const SeenLandmark& landmark : landmarks) {
      if (row_of(landmark.identity) == 0) append_unknown(landmark);
    }
  }
  std::vector<SeenLandmark> known;
  for (const SeenLandmark& landmark : landmarks) {
    if (row_of(landmark.identity) != 0) known.push_back(landmark);
  }
  if (!known.empty() && !correct(pose, known)) return false;
  for (const SeenLandmark& landmark : landmarks) {
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
bool JointBound::correct(const Pose& pose, std::span<const SeenLandmark> landmarks) {
  const auto m = 2 * static_cast<Eigen::Index>(landmarks.size());
  Eigen::MatrixXd gain(size_, m);  // P H'
  Eigen::MatrixXd S(m, m);
  std::vector<LinearisedDetection> observations;
  for (const SeenLandmark& landmark : landmarks) {
    const auto i = 2 * static_cast<Eigen::Index>(observations.size());
    const auto observation = linearised_detection(sensor_, pose, landmark.point);
    if (!observation) return false;
    observations.push_back(*observation);
    const Eigen::Index row = row_of(landmark.identity);
    const Matrix23& Hx = observation->by_pose;
    const Eigen::Matrix2d& Hf = observation->by_landmark;
    gain.middleCols<2>(i).noalias() = joint_.block(0, 0, size_, 3) * Hx.transpose();
    gain.middleCols<2>(i) += column(row) * Hf.col(0).transpose();
    gain.middleCols<2>(i) += column(row + 1) * Hf.col(1).transpose();
  }
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const auto i = 2 * static_cast<Eigen::Index>(k);
    S.middleRows<2>(i) =
        observations[k].by_pose * gain.topRows<3>() +
        observations[k].by_landmark * gain.middleRows<2>(row_of(landmarks[k].identity));
    S.diagonal().segment<2>(i) += observation_variance_;
  }
  return subtract(gain, S);
}

bool JointBound::fix(double variance) {
  finish_motion();
  const Eigen::MatrixXd S = pose_.topLeftCorner<2, 2>() + variance * Eigen::Matrix2d::Identity();
  return subtract(joint_.block(0, 0, size_, 2), S) && pose_.allFinite();
}

/// P <- P - W W' with W = `gain` L^-T and S = L L'.
bool JointBound::subtract(const Eigen::MatrixXd& gain, const Eigen::MatrixXd& S) {
  const Eigen::LLT<Eigen::MatrixXd> factor(S);
  if (factor.info() != Eigen::Success) return false;
  const Eigen::MatrixXd W = factor.matrixU().solve<Eigen::OnTheRight>(gain);
  joint_.topLeftCorner(size_, size_).selfadjointView<Eigen::Lower>().rankUpdate(W, -1.0);
  pose_ = joint_.topLeftCorner<3, 3>();
  mirror_lower(pose_);
  joint_.topLeftCorner<3, 3>() = pose_;
  return true;
}

void JointBound::append(const Pose& pose, const SeenLandmark& landmark) {
  const auto seen = linearised_detection(sensor_, pose, landmark.point);
  const auto placed = placed_landmark(sensor_, pose, seen->value);
  const Matrix23& Gx = placed->by_pose;
  const Eigen::Matrix2d& Gz = placed->by_detection;
  row_of(landmark.identity) = size_;
  joint_.block(size_, 0, 2, size_).noalias() = Gx * joint_.block(0, 0, size_, 3).transpose();
  joint_.block<2, 2>(size_, size_) =
      Gx * pose_ * Gx.transpose() + Gz * observation_variance_.asDiagonal() * Gz.transpose();
  size_ += 2;
}

void JointBound::append_unknown(const SeenLandmark& landmark) {
  row_of(landmark.identity) = size_;
  joint_.block(size_, 0, 2, size_).setZero();
  joint_.block<2, 2>(size_, size_) = kUnknown * kUnknown * Eigen::Matrix2d::Identity();
  size_ += 2;
}

double JointBound::mean_map_variance() const {
  double sum = 0.0, count = 0.0;
  for (Eigen::Index row = 3; row < size_; row += 2) {
    const double x = joint_(row, row), y = joint_(row + 1, row + 1);
    if (x + y > 0.01 * kUnknown * kUnknown) continue;  // all of its detections lie along one line
    sum += x;
    sum += y;
    count += 1.0;
  }
  return count == 0.0 ? kNaN : sum / count;
}

}  // namespace montecarta::analysis
