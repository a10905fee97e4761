// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/segment.hpp"

#include "filters/joint/joint_gaussian.hpp"
#include "filters/joint/products.hpp"
#include "filters/joint/retraction.hpp"

namespace montecarta::filters {
namespace {

/// L^-1 A.
template <int N>
Eigen::Matrix<double, 2, N> whitened(const InnovationFactor& L, Eigen::Matrix<double, 2, N> A) {
  for (Eigen::Index j = 0; j < N; ++j) A.col(j) = L.whiten(A.col(j));
  return A;
}

}  // namespace

void Segment::linearise(const FactorGraph& graph, const GraphEstimate& estimate, std::size_t begin,
                        std::size_t end, const SensorNoise& noise, SegmentScratch& scratch) {
  begin_ = begin;
  end_ = end;
  start(graph, scratch);
  Pose before = begin == 0 ? graph.start() : estimate.poses[begin - 1];
  for (std::size_t t = begin; t < end; ++t) {
    const Pose& pose = estimate.poses[t];
    carry(graph.motion(t), before, pose, estimate.directions[t]);
    for (const FactorGraph::Observation& observation : graph.observations_of(t)) {
      condition(observation, pose, estimate.landmarks[observation.landmark], noise, scratch);
    }
    before = pose;
  }
  const auto used = scratch.panel.topLeftCorner(
      given_.rows(), 2 * static_cast<Eigen::Index>(observations_.size()));
  add_product(used, used, Part::lower, scratch.information);
  on_pose_ = scratch.information.middleCols<3>(kPoseRow);
  on_pose_.row(0) = scratch.information.col(0).segment<3>(kPoseRow).transpose();
  for (const std::uint32_t landmark : landmarks_) scratch.row_of_landmark[landmark] = 0;
}

void Segment::start(const FactorGraph& graph, SegmentScratch& scratch) {
  motions_.clear();
  observations_.clear();
  landmarks_.clear();
  scratch.row_of_landmark.resize(graph.landmarks(), 0);
  for (std::size_t k = graph.begin_of(begin_); k < graph.begin_of(end_); ++k) {
    const std::uint32_t landmark = graph.observation(k).landmark;
    Eigen::Index& row = scratch.row_of_landmark[landmark];
    if (row > 0) continue;
    row = kLandmarkRow + row_of(landmarks_.size());
    landmarks_.push_back(landmark);
  }
  const Eigen::Index height = kLandmarkRow + packed(landmarks_.size());
  const auto rows = static_cast<Eigen::Index>(2 * (graph.begin_of(end_) - graph.begin_of(begin_)));
  scratch.information.setZero(height, height);
  if (scratch.panel.rows() < height || scratch.panel.cols() < rows) {
    scratch.panel.resize(2 * height, 2 * rows);
  }
  given_.setZero(height, 3);
  given_.middleRows<3>(kPoseRow).setIdentity();
  covariance_.setZero();
}

/// x <- A x + offset + noise.
void Segment::carry(const MotionIncrement& motion, const Pose& before, const Pose& after,
                    const Direction<double>& heading) {
  const Eigen::Vector2d moved = place_of(after) - place_of(before);
  const Eigen::Vector2d expected =
      to_vector(in_world(heading, motion.pose().x, motion.pose().y)) - moved;
  const double turned_by = wrap(after.heading - before.heading);
  const LinearMotion linear{
      .way = quarter_turn() * moved,
      .offset = {expected.x(), expected.y(), wrap(motion.pose().heading - turned_by)}};
  for (Eigen::Index i = 0; i < 2; ++i) given_.col(i) += linear.way(i) * given_.col(2);
  given_.row(0) += linear.offset.transpose();
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
  A.topRightCorner<2, 1>() = linear.way;
  covariance_ = A * covariance_ * A.transpose() + symmetric(turned(motion.covariance(), heading));
  mirror_lower(covariance_);
  motions_.push_back(linear);
}

/// An observation whose landmark is too near for a bearing is left out of this linearisation.
void Segment::condition(const FactorGraph::Observation& observation, const Pose& pose,
                        const Point& landmark, const SensorNoise& noise, SegmentScratch& scratch) {
  const auto at = linearised_observation(pose, landmark);
  LinearObservation seen{Matrix23::Zero(), Eigen::Matrix2d::Zero(), Eigen::Vector2d::Zero(),
                         Matrix32::Zero(), Eigen::Vector2d::Zero()};
  if (!too_near(at.observation)) {
    const Matrix23 H = pose_jacobian(at);
    Eigen::Matrix2d S = H * covariance_ * H.transpose();
    S.diagonal() += Eigen::Vector2d(noise.range, noise.bearing);
    if (const auto L = factor(S)) {
      seen.pose = whitened(*L, H);
      seen.landmark = whitened(*L, landmark_jacobian(at));
      seen.residual = L->whiten(to_vector(residual(observation.observed, at.observation)));
      seen.gain = covariance_ * seen.pose.transpose();
    }
  }
  add_rows(seen, scratch.row_of_landmark[observation.landmark], scratch);
}

/// Two rows of the sum of squares, and what they say of the pose.
void Segment::add_rows(const LinearObservation& seen, Eigen::Index row, SegmentScratch& scratch) {
  const auto first = 2 * static_cast<Eigen::Index>(observations_.size());
  auto used = scratch.panel.block(0, first, given_.rows(), 2);
  used.noalias() = given_.lazyProduct(seen.pose.transpose());
  used.row(0) -= seen.residual.transpose();
  used.middleRows<2>(row) += seen.landmark.transpose();
  for (Eigen::Index j = 0; j < 3; ++j) {
    given_.col(j) -= used.col(0) * seen.gain(j, 0) + used.col(1) * seen.gain(j, 1);
  }
  covariance_ -= seen.gain * seen.gain.transpose();
  mirror_lower(covariance_);
  observations_.push_back(seen);
}

double Segment::minimise(const FactorGraph& graph, const GraphEstimate& estimate,
                         const Eigen::VectorXd& landmark_steps, const Eigen::Vector3d& before,
                         const Eigen::Vector3d& adjoint, GraphMinimum& minimum) {
  const double squares = filter_poses(graph, landmark_steps, before);
  smooth_poses(graph, estimate, adjoint, minimum);
  return squares + adjoint.dot(covariance_ * adjoint);
}

/// Innovations of the poses' Kalman filter, given the landmarks.
double Segment::filter_poses(const FactorGraph& graph, const Eigen::VectorXd& landmark_steps,
                             Eigen::Vector3d x) {
  double squares = 0.0;
  const std::size_t first = graph.begin_of(begin_);
  for (std::size_t t = begin_; t < end_; ++t) {
    advance(t, Eigen::Vector3d::Zero(), x);
    for (std::size_t k = graph.begin_of(t); k < graph.begin_of(t + 1); ++k) {
      LinearObservation& seen = observations_[k - first];
      const auto landmark = landmark_steps.segment<2>(row_of(graph.observation(k).landmark));
      seen.innovation = seen.residual - seen.pose * x - seen.landmark * landmark;
      x += seen.gain * seen.innovation;
      squares += seen.innovation.squaredNorm();
    }
  }
  return squares;
}

void Segment::advance(std::size_t pose, const Eigen::Vector3d& noise, Eigen::Vector3d& x) const {
  const LinearMotion& motion = motions_[pose - begin_];
  x.head<2>() += motion.way * x(2);
  x += motion.offset + noise;
}

/// Backwards by Bryson and Frazier: a multiplier a pose, no covariance is inverted.
void Segment::smooth_poses(const FactorGraph& graph, const GraphEstimate& estimate,
                           Eigen::Vector3d adjoint, GraphMinimum& minimum) const {
  const std::size_t first = graph.begin_of(begin_);
  for (std::size_t t = end_; t-- > begin_;) {
    for (std::size_t k = graph.begin_of(t + 1); k-- > graph.begin_of(t);) {
      const LinearObservation& seen = observations_[k - first];
      adjoint += seen.pose.transpose() * (seen.innovation - seen.gain.transpose() * adjoint);
    }
    const Direction<double>& heading = estimate.directions[t];
    Eigen::Vector3d& multiplier = minimum.multipliers[t];
    multiplier << heading.cosine * adjoint(0) + heading.sine * adjoint(1),
        heading.cosine * adjoint(1) - heading.sine * adjoint(0), adjoint(2);
    const Eigen::Vector3d way = symmetric(graph.motion(t).covariance()) * multiplier;
    const Pose& mean = graph.motion(t).pose();
    minimum.displacements[t] = {mean.x + way(0), mean.y + way(1), wrap(mean.heading + way(2))};
    adjoint(2) += motions_[t - begin_].way.dot(adjoint.head<2>());
  }
}

}  // namespace montecarta::filters
