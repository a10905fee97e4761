// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/elimination.hpp"

#include "filters/joint/joint_gaussian.hpp"
#include "filters/joint/products.hpp"
#include "filters/joint/retraction.hpp"

#include <algorithm>

namespace montecarta::filters {
namespace {

/// Row of the first landmark: row 0 is that of the constant, row 1 is empty.
constexpr Eigen::Index kConstantRows = 2;
/// Rows of observations that are multiplied at once.
constexpr Eigen::Index kPanel = 128;

Eigen::Index row_in_form(std::size_t landmark) { return kConstantRows + row_of(landmark); }

Eigen::Vector2d place_of(const Pose& pose) { return {pose.x, pose.y}; }

/// L^-1 A.
template <int N>
Eigen::Matrix<double, 2, N> whitened(const InnovationFactor& L, Eigen::Matrix<double, 2, N> A) {
  for (Eigen::Index j = 0; j < N; ++j) A.col(j) = L.whiten(A.col(j));
  return A;
}

}  // namespace

void Elimination::begin(const FactorGraph& graph) {
  motions_.clear();
  observations_.clear();
  rows_ = kConstantRows;
  height_ = packed(graph.landmarks() + 1);
  if (information_.rows() < height_) {
    information_.resize(2 * height_, 2 * height_);
    given_.resize(2 * height_, 3);
    panel_.resize(2 * height_, kPanel);
  }
  information_.topLeftCorner(height_, height_).setZero();
  given_.topRows(height_).setZero();
  covariance_.setZero();
  filled_ = 0;
}

bool Elimination::linearise(const FactorGraph& graph, const GraphEstimate& estimate) {
  begin(graph);
  Pose before = graph.start();
  for (std::size_t t = 0; t < graph.poses(); ++t) {
    const Pose& pose = estimate.poses[t];
    carry(graph.motion(t), before, pose);
    for (const FactorGraph::Observation& observation : graph.observations_of(t)) {
      condition(observation, pose, estimate.landmarks[observation.landmark]);
    }
    before = pose;
  }
  flush();
  const Eigen::Index n = row_of(graph.landmarks());
  if (n == 0) return true;
  factor_.compute(information_.block(kConstantRows, kConstantRows, n, n));
  return factor_.info() == Eigen::Success;
}

/// x <- A x + offset + noise.
void Elimination::carry(const MotionIncrement& motion, const Pose& before, const Pose& after) {
  const Direction<double> heading = direction_of(before.heading);
  const Eigen::Vector2d moved = place_of(after) - place_of(before);
  const Eigen::Vector2d expected =
      to_vector(in_world(heading, motion.pose().x, motion.pose().y)) - moved;
  const double turned_by = wrap(after.heading - before.heading);
  const LinearMotion linear{
      .way = quarter_turn() * moved,
      .offset = {expected.x(), expected.y(), wrap(motion.pose().heading - turned_by)}};
  for (Eigen::Index i = 0; i < 2; ++i) {
    given_.col(i).head(rows_) += linear.way(i) * given_.col(2).head(rows_);
  }
  given_.row(0) += linear.offset.transpose();
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
  A.topRightCorner<2, 1>() = linear.way;
  covariance_ = A * covariance_ * A.transpose() + symmetric(turned(motion.covariance(), heading));
  mirror_lower(covariance_);
  motions_.push_back(linear);
}

/// An observation whose landmark is too near for a bearing is left out of this linearisation.
void Elimination::condition(const FactorGraph::Observation& observation, const Pose& pose,
                            const Point& landmark) {
  const auto at = linearised_observation(pose, landmark);
  LinearObservation seen{Matrix23::Zero(), Eigen::Matrix2d::Zero(), Eigen::Vector2d::Zero(),
                         Matrix32::Zero(), Eigen::Vector2d::Zero()};
  const Eigen::Index row = row_in_form(observation.landmark);
  rows_ = std::max(rows_, row + 2);
  if (!too_near(at.observation)) {
    const Matrix23 H = pose_jacobian(at);
    Eigen::Matrix2d S = H * covariance_ * H.transpose();
    S.diagonal() += Eigen::Vector2d(noise_.range, noise_.bearing);
    if (const auto L = factor(S)) {
      seen.pose = whitened(*L, H);
      seen.landmark = whitened(*L, landmark_jacobian(at));
      seen.residual = L->whiten(to_vector(residual(observation.observed, at.observation)));
      seen.gain = covariance_ * seen.pose.transpose();
      add_rows(seen, row);
    }
  }
  observations_.push_back(seen);
}

/// Two rows of the sum of squares, and what they say of the pose.
void Elimination::add_rows(const LinearObservation& seen, Eigen::Index row) {
  if (filled_ == kPanel) flush();
  auto columns = panel_.middleCols<2>(filled_);
  filled_ += 2;
  columns.topRows(height_).setZero();
  auto used = columns.topRows(rows_);
  used.noalias() = given_.topRows(rows_).lazyProduct(seen.pose.transpose());
  used.row(0) -= seen.residual.transpose();
  used.middleRows<2>(row) += seen.landmark.transpose();
  for (Eigen::Index j = 0; j < 3; ++j) {
    given_.col(j).head(rows_) -= used.col(0) * seen.gain(j, 0) + used.col(1) * seen.gain(j, 1);
  }
  covariance_ -= seen.gain * seen.gain.transpose();
  mirror_lower(covariance_);
}

void Elimination::flush() {
  const Eigen::Index rows = std::min((rows_ + kPack - 1) / kPack * kPack, height_);
  const auto used = panel_.topLeftCorner(rows, filled_);
  add_product(used, used, Part::lower, information_.topLeftCorner(rows, rows));
  filled_ = 0;
}

void Elimination::minimise(const FactorGraph& graph, const GraphEstimate& estimate,
                           GraphMinimum& minimum) {
  const Eigen::Index n = row_of(graph.landmarks());
  step_ = -information_.col(0).segment(kConstantRows, n);
  if (n > 0) factor_.solveInPlace(step_);
  filter_poses(graph);
  minimum.squares = 0.0;
  for (const LinearObservation& seen : observations_)
    minimum.squares += seen.innovation.squaredNorm();
  smooth_poses(graph, estimate, minimum);
  place_landmarks(graph, estimate, minimum);
}

/// Innovations of the poses' Kalman filter, given the landmarks.
void Elimination::filter_poses(const FactorGraph& graph) {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  for (std::size_t t = 0; t < graph.poses(); ++t) {
    const LinearMotion& motion = motions_[t];
    x.head<2>() += motion.way * x(2);
    x += motion.offset;
    for (std::size_t k = graph.begin_of(t); k < graph.begin_of(t + 1); ++k) {
      LinearObservation& seen = observations_[k];
      const auto landmark = step_.segment<2>(row_of(graph.observation(k).landmark));
      seen.innovation = seen.residual - seen.pose * x - seen.landmark * landmark;
      x += seen.gain * seen.innovation;
    }
  }
}

/// Backwards by Bryson and Frazier: a multiplier a pose, no covariance is inverted.
void Elimination::smooth_poses(const FactorGraph& graph, const GraphEstimate& estimate,
                               GraphMinimum& minimum) const {
  minimum.multipliers.resize(graph.poses());
  minimum.displacements.resize(graph.poses());
  Eigen::Vector3d adjoint = Eigen::Vector3d::Zero();
  for (std::size_t t = graph.poses(); t-- > 0;) {
    for (std::size_t k = graph.begin_of(t + 1); k-- > graph.begin_of(t);) {
      const LinearObservation& seen = observations_[k];
      adjoint += seen.pose.transpose() * (seen.innovation - seen.gain.transpose() * adjoint);
    }
    const Pose& before = t == 0 ? graph.start() : estimate.poses[t - 1];
    const Direction<double> heading = direction_of(before.heading);
    Eigen::Vector3d& multiplier = minimum.multipliers[t];
    multiplier << heading.cosine * adjoint(0) + heading.sine * adjoint(1),
        heading.cosine * adjoint(1) - heading.sine * adjoint(0), adjoint(2);
    const Eigen::Vector3d way = symmetric(graph.motion(t).covariance()) * multiplier;
    const Pose& mean = graph.motion(t).pose();
    minimum.displacements[t] = {mean.x + way(0), mean.y + way(1), wrap(mean.heading + way(2))};
    adjoint(2) += motions_[t].way.dot(adjoint.head<2>());
  }
}

/// The landmarks' steps in the frames of their first poses, which step as well.
void Elimination::place_landmarks(const FactorGraph& graph, const GraphEstimate& estimate,
                                  GraphMinimum& minimum) {
  minimum.in_frame.resize(graph.landmarks());
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  std::size_t l = 0;
  for (std::size_t t = 0; t < graph.poses(); ++t) {
    const Pose& before = t == 0 ? graph.start() : estimate.poses[t - 1];
    const Point noise = in_world(direction_of(before.heading),
                                 minimum.displacements[t].x - graph.motion(t).pose().x,
                                 minimum.displacements[t].y - graph.motion(t).pose().y);
    x.head<2>() += motions_[t].way * x(2) + to_vector(noise);
    x(2) += wrap(minimum.displacements[t].heading - graph.motion(t).pose().heading);
    x += motions_[t].offset;
    const Pose& pose = estimate.poses[t];
    for (; l < graph.landmarks() && graph.first_pose_of(l) == t; ++l) {
      const Eigen::Vector2d away = to_vector(estimate.landmarks[l]) - place_of(pose);
      const Eigen::Vector2d step =
          step_.segment<2>(row_of(l)) - x.head<2>() - quarter_turn() * away * x(2);
      const Pose moved = relative_to({0.0, 0.0, pose.heading}, {step.x(), step.y(), 0.0});
      minimum.in_frame[l] = estimate.in_frame[l] + Point{moved.x, moved.y};
    }
  }
}

void Elimination::covariance(Eigen::Matrix3d& pose, MapMoments& map) const {
  const Eigen::Index n = factor_.rows();
  map.make_room(packed(static_cast<std::size_t>(n / 2)));
  map.clear(map.room());
  const auto G = given_.middleRows(kConstantRows, n);
  auto P = map.covariance.topLeftCorner(n, n);
  P.setIdentity();
  factor_.solveInPlace(P);
  P.triangularView<Eigen::StrictlyUpper>() = P.transpose();
  map.cross.topRows(n).noalias() = P * G;
  pose = covariance_ + G.transpose() * map.cross.topRows(n);
  mirror_lower(pose);
}

}  // namespace montecarta::filters
