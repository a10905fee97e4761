// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/robocentric_frame.hpp"

#include <array>

namespace montecarta::filters {

void RobocentricFrame::start(const Pose& start, CompressedGaussian& gaussian) {
  start_ = origin_ = {start.x, start.y};
  axis_ = Eigen::Vector2d::UnitX();
  heading_ = 0.0;
  covariance_.setZero();
  for (const Eigen::Vector2d& point : {origin_, Eigen::Vector2d(origin_ + axis_)}) {
    gaussian.append(
        NewPoint{.mean = point, .by_pose = Matrix23::Zero(), .noise = Eigen::Matrix2d::Zero()});
  }
}

void RobocentricFrame::centre(CompressedGaussian& gaussian) {
  gaussian.centre_on_pose();
  origin_ = gaussian.mean_of(0);
  const Eigen::Vector2d across = quarter_turn() * axis_;
  const double turn = across.dot(gaussian.mean_of(1) - origin_);
  const Direction<double> d = direction_of(turn);
  axis_ = (d.cosine * axis_ + d.sine * across).eval();
  heading_ = wrap(heading_ + turn);
  const Eigen::Vector2d now_across = quarter_turn() * axis_;
  const Eigen::Matrix2d A = now_across * across.transpose();
  std::array<NewPoint::Part, 2> parts{{{0, Eigen::Matrix2d::Identity() - A}, {1, A}}};
  gaussian.replace(1, NewPoint{.mean = origin_ + axis_,
                               .by_pose = Matrix23::Zero(),
                               .noise = Eigen::Matrix2d::Zero(),
                               .by_points = parts});
  const Eigen::Matrix4d P = gaussian.covariance_with(0, 1).bottomRightCorner<4, 4>();
  Eigen::Matrix<double, 3, 4> T = Eigen::Matrix<double, 3, 4>::Zero();
  T.topLeftCorner<2, 2>().setIdentity();
  T.row(2) << -now_across.transpose(), now_across.transpose();
  covariance_ = T * P * T.transpose();
  mirror_lower(covariance_);
}

/// Rotation from the axes of the Gaussian to those of the map.
Eigen::Matrix2d RobocentricFrame::to_map() const {
  Eigen::Matrix2d R;
  R << axis_.transpose(), (quarter_turn() * axis_).transpose();
  return R;
}

Eigen::Vector2d RobocentricFrame::place_in_map(const Eigen::Vector2d& place) const {
  return start_ + to_map() * (place - origin_);
}

/// Derivative of place_in_map() by origin and heading.
Eigen::Matrix<double, 2, 3> RobocentricFrame::by_frame(const Eigen::Vector2d& place) const {
  Eigen::Matrix<double, 2, 3> derivative;
  derivative << -to_map(), -quarter_turn() * (to_map() * (place - origin_));
  return derivative;
}

PoseMoments RobocentricFrame::in_map(const PoseMoments& pose) const {
  const Eigen::Vector2d place(pose.mean.x, pose.mean.y), at = place_in_map(place);
  Eigen::Matrix3d L = Eigen::Matrix3d::Identity(), B = Eigen::Matrix3d::Zero();
  L.topLeftCorner<2, 2>() = to_map();
  B.topRows<2>() = by_frame(place);
  B(2, 2) = -1.0;
  PoseMoments moments{{at.x(), at.y(), wrap(pose.mean.heading - heading_)},
                      L * pose.covariance * L.transpose() + B * covariance_ * B.transpose()};
  mirror_lower(moments.covariance);
  return moments;
}

LandmarkEstimate RobocentricFrame::in_map(const CompressedGaussian& gaussian,
                                          std::size_t slot) const {
  const Eigen::Vector2d place = gaussian.mean_of(slot);
  const Matrix7 with_origin = gaussian.covariance_with(slot, 0);
  const Eigen::Matrix2d own = with_origin.block<2, 2>(3, 3), first = with_origin.block<2, 2>(3, 5);
  const Eigen::Matrix2d second = gaussian.covariance_with(slot, 1).block<2, 2>(3, 5);
  Eigen::Matrix<double, 2, 3> cross;
  cross << first, (second - first) * (quarter_turn() * axis_);
  const Eigen::Matrix2d R = to_map();
  const Eigen::Matrix<double, 2, 3> B = by_frame(place);
  const Eigen::Matrix2d mixed = R * cross * B.transpose();
  return {place_in_map(place),
          R * own * R.transpose() + mixed + mixed.transpose() + B * covariance_ * B.transpose()};
}

void RobocentricFrame::put_in_map(JointEstimate& joint) const {
  const Eigen::Index n = joint.mean.size();
  Eigen::RowVector4d heading;  // derivative of the frame's heading by its points
  heading << -(quarter_turn() * axis_).transpose(), (quarter_turn() * axis_).transpose();
  Eigen::MatrixXd T = Eigen::MatrixXd::Identity(n, n);
  const auto put = [&](Eigen::Index row) {
    const Eigen::Vector2d place = joint.mean.segment<2>(row);
    const Eigen::Matrix<double, 2, 3> B = by_frame(place);
    T.block<2, 2>(row, row) = to_map();
    T.block<2, 2>(row, 3) += B.leftCols<2>();
    T.block<2, 4>(row, 3) += B.col(2) * heading;
    joint.mean.segment<2>(row) = place_in_map(place);
  };
  put(0);
  T.block<1, 4>(2, 3) = -heading;
  joint.mean(2) = wrap(joint.mean(2) - heading_);
  for (Eigen::Index row = 7; row < n; row += 2) put(row);
  const Eigen::MatrixXd half = T * joint.covariance;
  joint.covariance.noalias() = half * T.transpose();
}

}  // namespace montecarta::filters
