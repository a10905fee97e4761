// SPDX-License-Identifier: BSD-3-Clause
#include "filters/equivariant/polar_gaussian.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::filters {
namespace {

/// The matrix of the product of complex numbers with a + i b.
Eigen::Matrix2d times(const Eigen::Vector2d& factor) {
  return Eigen::Matrix2d{{factor.x(), -factor.y()}, {factor.y(), factor.x()}};
}

/// a / b of complex numbers.
Eigen::Vector2d quotient(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return times(b).transpose() * a / b.squaredNorm();
}

/// The exponential of a complex number.
Eigen::Vector2d exponential(const Eigen::Vector2d& exponent) {
  const Direction<double> d = direction_of(exponent.y());
  return std::exp(exponent.x()) * Eigen::Vector2d(d.cosine, d.sine);
}

/// The first row that is stored of a column: the first one of its block on the diagonal.
Eigen::Index first_stored(Eigen::Index column) {
  return column < 3 ? 0 : column - (column - 3) % 2;
}

/// The error of the pose after a motion, by the error of the motion in the frame of `before`.
Eigen::Matrix3d by_motion(const Pose& before, const Pose& after) {
  Eigen::Matrix3d derivative = Eigen::Matrix3d::Identity();
  derivative.topLeftCorner<2, 2>() = rotation_by(before.heading);
  derivative.topRightCorner<2, 1>() = -quarter_turned(place_of(after));
  return derivative;
}

}  // namespace

void PolarGaussian::start(const Pose& start) {
  start_ = start;
  pose_ = {};
  places_.clear();
  if (covariance_.size() == 0) covariance_.resize(3, 3);
  covariance_.topLeftCorner<3, 3>().setZero();
}

void PolarGaussian::move(const MotionIncrement& motion) {
  const Eigen::Matrix3d C = symmetric(motion.covariance());
  const Pose before = pose_;
  pose_ = motion.from(before).mean;
  const Eigen::Matrix3d N = by_motion(before, pose_);
  const Eigen::Vector2d way = place_of(motion.pose());
  const Eigen::Matrix2d back = rotation_by(-motion.pose().heading);
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const Eigen::Vector2d from = places_[k], left = from - way;
    kept_[k] = times(quotient(from, left));
    noise_[k].leftCols<2>() = -times(quotient(Eigen::Vector2d::UnitX(), left));
    noise_[k].col(2) = -Eigen::Vector2d::UnitY();
    places_[k] = back * left;
  }
  auto frame = covariance_.topLeftCorner<3, 3>();
  frame = (frame + N * C * N.transpose()).eval();
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const Eigen::Matrix<double, 2, 3> noise = noise_[k] * C;
    auto cross = covariance_.block<2, 3>(row_of(k), 0);
    cross = (kept_[k] * cross + noise * N.transpose()).eval();
    for (std::size_t j = 0; j <= k; ++j) {
      auto P = covariance_.block<2, 2>(row_of(k), row_of(j));
      P = (kept_[k] * P * kept_[j].transpose() + noise * noise_[j].transpose()).eval();
    }
  }
}

PoseMoments PolarGaussian::pose_after(const MotionIncrement& motion) const {
  const Pose after = motion.from(pose_).mean;
  const Pose in_map = MotionIncrement(after, {}).from(start_).mean;
  const Eigen::Matrix3d N = by_motion(pose_, after);
  Eigen::Matrix3d L = Eigen::Matrix3d::Identity(), turn = L;
  L.topRightCorner<2, 1>() = quarter_turned(place_of(after));
  turn.topLeftCorner<2, 2>() = rotation_by(start_.heading);
  L = (turn * L).eval();
  const Eigen::Matrix3d P = covariance_.topLeftCorner<3, 3>().selfadjointView<Eigen::Lower>();
  PoseMoments moments{in_map,
                      L * (P + N * symmetric(motion.covariance()) * N.transpose()) * L.transpose()};
  mirror_lower(moments.covariance);
  return moments;
}

Eigen::Vector2d PolarGaussian::Expected::innovation(const Eigen::Vector2d& detected) const {
  return {std::log(detected(0) / range), wrap(detected(1) - bearing)};
}

std::optional<PolarGaussian::Expected> PolarGaussian::expected(std::size_t slot) const {
  const double range = places_[slot].norm();
  Eigen::Matrix2d S = covariance_.block<2, 2>(row_of(slot), row_of(slot));
  S(0, 0) += std::pow(belief_.sigma_range / range, 2);
  S(1, 1) += std::pow(belief_.sigma_bearing, 2);
  const auto L = factor(S);
  if (!L) return std::nullopt;
  return Expected{range, std::atan2(places_[slot].y(), places_[slot].x()), *L};
}

/// Copies both full columns of a landmark to `columns_`.
void PolarGaussian::copy_columns(std::size_t slot) {
  const Eigen::Index row = row_of(slot), n = rows();
  columns_.topRows(row) = covariance_.block(row, 0, 2, row).transpose();
  columns_.middleRows(row, n - row) = covariance_.block(row, row, n - row, 2);
}

void PolarGaussian::update_with(std::size_t slot, const Eigen::Vector2d& innovation,
                                const Expected& expected) {
  copy_columns(slot);
  const auto& [l00, l10, l11] = expected.factor;
  const Eigen::Index n = rows();
  columns_.col(0).head(n) /= l00;
  columns_.col(1).head(n) = (columns_.col(1).head(n) - l10 * columns_.col(0).head(n)) / l11;
  const Eigen::Vector2d white = expected.factor.whiten(innovation);
  const auto step = [&](Eigen::Index row) {
    return columns_(row, 0) * white(0) + columns_(row, 1) * white(1);
  };
  for (std::size_t k = 0; k < places_.size(); ++k)
    places_[k] = times(exponential({step(row_of(k)), step(row_of(k) + 1)})) * places_[k];
  const double turn = step(2);
  const Eigen::Vector2d place = rotation_by(turn) * place_of(pose_) +
                                exponential_jacobian(turn) * Eigen::Vector2d(step(0), step(1));
  pose_ = {place.x(), place.y(), wrap(pose_.heading + turn)};
  for (Eigen::Index column = 0; column < n; ++column) {
    const Eigen::Index first = first_stored(column), stored = n - first;
    covariance_.col(column).segment(first, stored) -=
        columns_(column, 0) * columns_.col(0).segment(first, stored) +
        columns_(column, 1) * columns_.col(1).segment(first, stored);
  }
}

void PolarGaussian::append(const Eigen::Vector2d& detected) {
  const Eigen::Index n = rows();
  const Direction<double> d = direction_of(detected(1));
  places_.emplace_back(detected(0) * d.cosine, detected(0) * d.sine);
  if (covariance_.rows() < n + 2) {
    covariance_.conservativeResize(2 * n + 2, 2 * n + 2);
    columns_.resize(2 * n + 2, 2);
  }
  noise_.resize(std::max(noise_.size(), places_.size()));
  kept_.resize(noise_.size());
  covariance_.block(n, 0, 2, n + 2).setZero();
  covariance_(n, n) = std::pow(belief_.sigma_range / detected(0), 2);
  covariance_(n + 1, n + 1) = std::pow(belief_.sigma_bearing, 2);
}

/// Derivative of a place in the map by the errors of the pose.
Eigen::Matrix<double, 2, 3> PolarGaussian::by_frame(const Eigen::Vector2d& place) const {
  Eigen::Matrix<double, 2, 3> derivative;
  derivative << Eigen::Matrix2d::Identity(), quarter_turned(place);
  return rotation_by(start_.heading) * derivative;
}

Eigen::Vector2d PolarGaussian::place_from_start(std::size_t slot) const {
  return place_of(pose_) + rotation_by(pose_.heading) * places_[slot];
}

/// Derivative of a landmark in the map by its own errors.
Eigen::Matrix2d PolarGaussian::by_own_error(std::size_t slot) const {
  return rotation_by(start_.heading + pose_.heading) * times(places_[slot]);
}

LandmarkEstimate PolarGaussian::landmark(std::size_t slot) const {
  const Eigen::Vector2d place = place_from_start(slot);
  const Eigen::Index row = row_of(slot);
  Eigen::Matrix<double, 2, 5> T;
  T << by_frame(place), by_own_error(slot);
  Eigen::Matrix<double, 5, 5> P;
  P << covariance_.topLeftCorner<3, 3>(), covariance_.block<2, 3>(row, 0).transpose(),
      covariance_.block<2, 3>(row, 0), covariance_.block<2, 2>(row, row);
  P.triangularView<Eigen::StrictlyUpper>() = P.transpose();
  return {place_of(start_) + rotation_by(start_.heading) * place, T * P * T.transpose()};
}

JointEstimate PolarGaussian::joint() const {
  const Eigen::Index n = rows();
  Eigen::VectorXd mean(n);
  Eigen::MatrixXd T = Eigen::MatrixXd::Identity(n, n);
  const auto put = [&](Eigen::Index row, const Eigen::Vector2d& place) {
    mean.segment<2>(row) = place_of(start_) + rotation_by(start_.heading) * place;
    T.block<2, 3>(row, 0) = by_frame(place);
  };
  put(0, place_of(pose_));
  mean(2) = wrap(start_.heading + pose_.heading);
  for (std::size_t k = 0; k < places_.size(); ++k) {
    put(row_of(k), place_from_start(k));
    T.block<2, 2>(row_of(k), row_of(k)) = by_own_error(k);
  }
  const Eigen::MatrixXd P = covariance_.topLeftCorner(n, n).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd half = T * P;
  return {mean, half * T.transpose()};
}

}  // namespace montecarta::filters
