// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/relative_laplace.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace montecarta::filters {
namespace {

/// Rearranges the rows of the landmarks of a segment to rows of all landmarks.
Segment::Rows of_all_landmarks(const Segment& segment, const Segment::Rows& own,
                               Eigen::Index rows) {
  Segment::Rows all = Segment::Rows::Zero(rows, 3);
  for (std::size_t k = 0; k < segment.landmarks().size(); ++k) {
    all.middleRows<2>(row_of(segment.landmarks()[k])) =
        own.middleRows<2>(Segment::kLandmarkRow + row_of(k));
  }
  return all;
}

/// Greatest number of poses that serve as frames of landmarks.
constexpr std::size_t kMostFrames = 40;

/// Distance, in standard deviations of the position, beyond which range and bearing are Gaussian.
constexpr double kPolarBeyond = 5.0;

/// Trace [m^2] of the covariance of the position of a landmark in a frame. P is the covariance of
/// poses and landmarks; `in_map` is the first row of the landmark in it.
double spread_in_frame(const Eigen::MatrixXd& P, std::size_t frame, Eigen::Index in_map,
                       const LinearisedDetection& place) {
  const auto& [value, by_pose, by_landmark] = place;
  Eigen::Matrix2d S = by_landmark * P.block<2, 2>(in_map, in_map) * by_landmark.transpose();
  if (frame > 0) {
    const Eigen::Index of_pose = row_of_pose(frame - 1);
    S += by_pose * P.block<3, 3>(of_pose, of_pose) * by_pose.transpose();
    S += 2.0 * by_pose * P.block<3, 2>(of_pose, in_map) * by_landmark.transpose();
  }
  return S.trace();
}

}  // namespace

/// Measurements after a pose x add x' N x / 2 + x' h' l to the negative log-density (EQUATIONS 21).
void PosesGivenMap::step_backwards(const Elimination& elimination, Eigen::Index rows) {
  steps_.resize(elimination.segments());
  Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
  Rows h = Rows::Zero(rows, 3);
  for (std::size_t i = steps_.size(); i-- > 0;) {
    const Segment& segment = elimination.segment(i);
    const Eigen::Matrix3d F = segment.given().middleRows<3>(Segment::kPoseRow).transpose();
    const Rows G = of_all_landmarks(segment, segment.given(), rows);
    const Eigen::Matrix3d& C = segment.covariance();
    const Eigen::PartialPivLU<Eigen::Matrix3d> lu(Eigen::Matrix3d::Identity() + C * N);
    steps_[i] = {lu.solve(F), lu.solve(C),
                 lu.solve((G - h.lazyProduct(C)).transpose()).transpose()};
    const Eigen::Matrix3d& T = steps_[i].transition;
    h = ((G.lazyProduct(N) + h).lazyProduct(T) + of_all_landmarks(segment, segment.on_pose(), rows))
            .eval();
    N = (F.transpose() * N * T + segment.on_pose().middleRows<3>(Segment::kPoseRow)).eval();
  }
}

Eigen::MatrixXd PosesGivenMap::covariance(const Elimination& elimination,
                                          std::span<const std::size_t> chosen) {
  Eigen::Matrix3d newest;
  elimination.covariance(newest, map_);
  const Eigen::Index n = elimination.map_rows(), poses = row_of_pose(chosen.size());
  step_backwards(elimination, n);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(poses + n, poses + n);
  Eigen::MatrixXd G(n, poses);  // derivatives by the landmarks, transposed
  Rows by_landmarks = Rows::Zero(n, 3);
  Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
  // Covariance of the last pose of segment i with the chosen poses so far.
  Eigen::Matrix<double, 3, Eigen::Dynamic> with_chosen(3, poses);
  Eigen::Index row = 0;
  for (std::size_t i = 0, next = 0; next < chosen.size(); ++i) {
    const LaplaceStep& step = steps_[i];
    by_landmarks =
        (by_landmarks.lazyProduct(step.transition.transpose()) + step.by_landmarks).eval();
    own = (step.transition * own * step.transition.transpose() + step.covariance).eval();
    with_chosen.leftCols(row) = (step.transition * with_chosen.leftCols(row)).eval();
    if (chosen[next] != i) continue;
    with_chosen.middleCols<3>(row) = own;
    G.middleCols<3>(row) = by_landmarks;
    P.block(row, 0, 3, row + 3) = with_chosen.leftCols(row + 3);
    row = row_of_pose(++next);
  }
  P.bottomRightCorner(n, n) = map_.covariance.topLeftCorner(n, n).selfadjointView<Eigen::Lower>();
  P.bottomLeftCorner(n, poses).noalias() = P.bottomRightCorner(n, n) * G;
  P.topLeftCorner(poses, poses).noalias() += G.transpose() * P.bottomLeftCorner(n, poses);
  return P.selfadjointView<Eigen::Lower>();
}

JointEstimate RelativeLaplace::of(const FactorGraph& graph, const GraphEstimate& estimate,
                                  const Elimination& elimination) {
  choose_frames(graph, elimination);
  const std::size_t n = frames_.size() + 1;
  mean_.resize(row_of_pose(n) + row_of(graph.landmarks()));
  by_map_.clear();
  chain_ = {.start = graph.start(), .displacements = {}, .landmarks = {}};
  points_.clear();
  for (std::size_t frame = 0; frame < n; ++frame) add_displacement(graph, estimate, frame);
  const Eigen::MatrixXd P = poses_given_map_.covariance(elimination, ends_);
  for (std::size_t l = 0; l < graph.landmarks(); ++l) add_landmark(graph, estimate, P, l);
  Eigen::SparseMatrix<double, Eigen::RowMajor> T(mean_.size(), P.rows());
  T.setFromTriplets(by_map_.begin(), by_map_.end());
  const Eigen::MatrixXd TP = T * P;
  return moments_.of(chain_, mean_, T * TP.transpose(), points_);
}

/// Frames are the last poses of the segments, without the last segment, in which landmarks were
/// observed first: all of them, or every second, third, ... one.
void RelativeLaplace::choose_frames(const FactorGraph& graph, const Elimination& elimination) {
  std::vector<std::size_t> first;
  for (std::size_t i = 0, l = 0; i + 1 < elimination.segments(); ++i) {
    const std::size_t before = l;
    while (l < graph.landmarks() && graph.first_pose_of(l) <= elimination.segment(i).last_pose())
      ++l;
    if (l > before) first.push_back(i);
  }
  const std::size_t stride = (first.size() + kMostFrames - 1) / kMostFrames;
  ends_.clear();
  frames_.clear();
  for (std::size_t i = 0; i < first.size(); i += stride) {
    ends_.push_back(first[i]);
    frames_.push_back(elimination.segment(first[i]).last_pose());
  }
  ends_.push_back(elimination.segments() - 1);
  newest_ = graph.poses() - 1;
}

void RelativeLaplace::add_derivative(Eigen::Index row, Eigen::Index column,
                                     const Eigen::MatrixXd& block) {
  for (Eigen::Index i = 0; i < block.rows(); ++i) {
    for (Eigen::Index j = 0; j < block.cols(); ++j)
      by_map_.emplace_back(static_cast<int>(row + i), static_cast<int>(column + j), block(i, j));
  }
}

/// Adds the displacement from the frame before to this one or, after the last, to the newest pose.
void RelativeLaplace::add_displacement(const FactorGraph& graph, const GraphEstimate& estimate,
                                       std::size_t frame) {
  const Eigen::Index row = row_of_pose(frame);
  const Pose& origin = frame == 0 ? graph.start() : estimate.poses[frames_[frame - 1]];
  const Pose& end = estimate.poses[frame < frames_.size() ? frames_[frame] : newest_];
  const LinearisedDetection way = PositionSensor::linearised(origin, {end.x, end.y}).value();
  mean_.segment<3>(row) << way.value, wrap(end.heading - origin.heading);
  chain_.displacements.push_back(row);
  if (frame > 0) {
    add_derivative(row, row_of_pose(frame - 1), way.by_pose);
    by_map_.emplace_back(row + 2, row_of_pose(frame - 1) + 2, -1.0);
  }
  add_derivative(row, row_of_pose(frame), way.by_landmark);
  by_map_.emplace_back(row + 2, row_of_pose(frame) + 2, 1.0);
}

/// Adds a landmark in the first frame after the pose that observed it first, or in the last frame.
/// Frame 0 is the start.
void RelativeLaplace::add_landmark(const FactorGraph& graph, const GraphEstimate& estimate,
                                   const Eigen::MatrixXd& P, std::size_t landmark) {
  const auto behind = static_cast<std::size_t>(
      std::ranges::lower_bound(frames_, graph.first_pose_of(landmark)) - frames_.begin());
  const std::size_t frame = std::min(behind + 1, frames_.size());
  const Pose& origin = frame == 0 ? graph.start() : estimate.poses[frames_[frame - 1]];
  const Point& place = estimate.landmarks[landmark];
  const Eigen::Index row = row_of_pose(frames_.size() + 1) + row_of(landmark);
  const Eigen::Index in_map = row_of_pose(ends_.size()) + row_of(landmark);
  LinearisedDetection at = PositionSensor::linearised(origin, place).value();
  const double nearest_squared =
      kPolarBeyond * kPolarBeyond * spread_in_frame(P, frame, in_map, at);
  const auto polar = RangeBearingSensor::linearised(origin, place);
  const bool is_polar = polar && at.value.squaredNorm() > nearest_squared;
  points_.push_back({row, frame, is_polar});
  if (is_polar) at = *polar;
  mean_.segment<2>(row) = at.value;
  if (frame > 0) add_derivative(row, row_of_pose(frame - 1), at.by_pose);
  add_derivative(row, in_map, at.by_landmark);
}

}  // namespace montecarta::filters
