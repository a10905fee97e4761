// SPDX-License-Identifier: BSD-3-Clause
#include "filters/ekf_slam/joint_gaussian.hpp"

#include <cmath>

namespace montecarta {

/// P <- T P T', T = I + d e_heading' with d = J step: the covariance, in the map frame, of an
/// invariant error that stayed while the estimate moved by `pose_step` and map_step_.
void JointGaussian::transport(const Eigen::Vector2d& pose_step) {
  const Eigen::Vector2d d = quarter_turn() * pose_step;
  apply(quarter_turn(), map_step_.leftCols(rows() / 2));
  const Eigen::Vector3d heading_row = pose_.covariance.row(2).transpose();
  transport_map(heading_row(2));
  auto cross = cross_.topRows(rows());
  cross += map_step_.reshaped().head(rows()).lazyProduct(heading_row.transpose());
  cross.col(0) += d(0) * cross.col(2);
  cross.col(1) += d(1) * cross.col(2);
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  T.topRightCorner<2, 1>() = d;
  pose_.covariance = (T * pose_.covariance * T.transpose()).eval();
  pose_.covariance.triangularView<Eigen::StrictlyUpper>() = pose_.covariance.transpose();
}

/// The landmarks' share, P + d c' + c d' + d h d' with c and h the covariances with the heading, as
/// two squares, which are exactly symmetric: P - b b' + a a' with b = c / sqrt(h), a = b + sqrt(h)
/// d. Neither is larger than P, so nothing cancels.
void JointGaussian::transport_map(double heading_variance) {
  if (!(heading_variance > 0.0)) return;
  const double sigma = std::sqrt(heading_variance);
  auto b = gain_map_.col(0).head(rows());
  auto a = gain_map_.col(1).head(rows());
  b = cross_.col(2).head(rows()) / sigma;
  a = b + sigma * map_step_.reshaped().head(rows());
  for (Eigen::Index j = 0; j < 2 * static_cast<Eigen::Index>(n_landmarks_); ++j) {
    map_.col(j).head(rows()) += a * a(j) - b * b(j);
  }
}

}  // namespace montecarta
