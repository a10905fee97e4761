// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/cloud_moments.hpp"

namespace montecarta {

PoseEstimate CloudMoments::moved_by(const MotionIncrement& increment) const {
  const Direction<double> d = direction_of(mean_.heading);
  const Pose& step = increment.pose();
  const Eigen::Matrix2d turn{{d.cosine, -d.sine}, {d.sine, d.cosine}};
  const Eigen::Vector2d way =
      turn * Eigen::Vector2d(step.x, step.y);  // of a particle at the mean heading

  const double c = 1.0 + cosine_, s = sine_;
  const Pose mean{mean_.x + c * way.x() - s * way.y(), mean_.y + s * way.x() + c * way.y(),
                  wrap(mean_.heading + step.heading)};
  Eigen::Matrix<double, 3, 5> A = Eigen::Matrix<double, 3, 5>::Zero();
  A.leftCols<3>().setIdentity();
  A.block<2, 2>(0, 3) << way.x(), -way.y(), way.y(), way.x();
  const Eigen::Matrix3d spread = A * centred_ * A.transpose();

  // E[R P R'] over the particles' turns R = [cos h, -sin h; sin h, cos h] from the mean heading
  const double cc = 1.0 + 2.0 * cosine_ + second_(3, 3), cs = sine_ + second_(3, 4),
               ss = second_(4, 4);
  const Eigen::Matrix2d P = turn * increment.covariance().topLeftCorner<2, 2>() * turn.transpose();
  const Eigen::Vector2d p = turn * increment.covariance().topRightCorner<2, 1>();
  Eigen::Matrix3d own;
  own(0, 0) = cc * P(0, 0) - 2.0 * cs * P(0, 1) + ss * P(1, 1);
  own(1, 1) = ss * P(0, 0) + 2.0 * cs * P(0, 1) + cc * P(1, 1);
  own(0, 1) = own(1, 0) = cs * (P(0, 0) - P(1, 1)) + (cc - ss) * P(0, 1);
  own(0, 2) = own(2, 0) = c * p.x() - s * p.y();
  own(1, 2) = own(2, 1) = s * p.x() + c * p.y();
  own(2, 2) = increment.covariance()(2, 2);
  return {{mean, spread}, PoseMoments{mean, spread + own}};
}

}  // namespace montecarta
