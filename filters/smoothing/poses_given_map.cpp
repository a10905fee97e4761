// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/poses_given_map.hpp"

#include "filters/joint/map_moments.hpp"

#include <Eigen/LU>

namespace montecarta::filters {
namespace {

/// A segment's rows of landmarks, as rows of all landmarks.
Segment::Rows of_all_landmarks(const Segment& segment, const Segment::Rows& own,
                               Eigen::Index rows) {
  Segment::Rows all = Segment::Rows::Zero(rows, 3);
  for (std::size_t k = 0; k < segment.landmarks().size(); ++k) {
    all.middleRows<2>(row_of(segment.landmarks()[k])) =
        own.middleRows<2>(Segment::kLandmarkRow + row_of(k));
  }
  return all;
}

}  // namespace

/// What comes after a pose x, its own observations left out, tells of it x' N x / 2 + x' h' l.
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
  Eigen::Matrix<double, 3, Eigen::Dynamic> with_chosen(3, poses);  // of those so far
  Eigen::Index row = 0;
  for (std::size_t i = 0, next = 0; next < chosen.size(); ++i) {
    const Step& step = steps_[i];
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

}  // namespace montecarta::filters
