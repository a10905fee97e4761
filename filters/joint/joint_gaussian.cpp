// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_gaussian.hpp"

#include "engine/errors.hpp"
#include "filters/moments/sigma_rule.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <utility>

namespace montecarta::filters {
namespace {

/// Iterations stop if the innovation changes by less than this, in units of its standard deviation.
constexpr double kConverged = 1e-4;

/// L^-T. For the triangular factor it takes two divisions; S itself is never inverted.
Eigen::Matrix2d inverse_transposed(const InnovationFactor& L) {
  Eigen::Matrix2d inverse;
  inverse << 1.0 / L.l00, -L.l10 / (L.l00 * L.l11), 0.0, 1.0 / L.l11;
  return inverse;
}

using Matrix3 = Eigen::Matrix3d;
using Matrix35 = Eigen::Matrix<double, 3, 5>;

/// The nonlinear arguments of observations and motions have at most three dimensions.
SigmaRule rule() { return unscented_rule(3.0, 1.0, 0.0, 0.0); }

/// [m^2, rad^2] added to variances, so that slopes exist for quantities that are known exactly.
constexpr double kSmallest = 1e-14;

/// Derivative, by (x, y, heading, landmark's x, y), of the vector to the landmark along and across
/// the line of sight, and of the heading. Its axes make the estimate rotate with the world. The
/// right-invariant error of the vector is that to the vector that turns with the heading.
Matrix35 line_of_sight(const Eigen::Vector2d& away, Retraction retraction) {
  const double range = away.norm();
  Eigen::Vector2d ray = Eigen::Vector2d::UnitX();
  if (range > 0.0) ray = away / range;
  Eigen::Matrix2d axes;
  axes << ray.transpose(), (quarter_turn() * ray).transpose();
  Matrix35 T = Matrix35::Zero();
  T.topLeftCorner<2, 2>() = -axes;
  T.topRightCorner<2, 2>() = axes;
  T(2, 2) = 1.0;
  if (retraction == Retraction::right_invariant) T(1, 2) = -range;
  return T;
}

/// The vector `away` between two points whose errors differ by `way` and that turn by `turn`.
Eigen::Vector2d retracted(const Eigen::Vector2d& away, const Eigen::Vector2d& way, double turn,
                          Retraction retraction) {
  if (retraction == Retraction::additive) return away + way;
  const Eigen::Vector2d moved = exponential_jacobian(turn) * way;
  if (retraction == Retraction::left_invariant) return away + moved;
  return rotation_by(turn) * away + moved;
}

/// Images of pairs of sigma points minus that of the centre: half their difference, and their mean.
struct JointDifferences {
  Matrix23 odd, even;
};

/// Covariance of the nonlinear part, including that of the shift of the mean.
Eigen::Matrix2d curvature(const Matrix23& even, const Eigen::Vector2d& shift) {
  return rule().symmetric * even * even.transpose() + rule().shift * shift * shift.transpose();
}

/// Calls `observe` for the steps along the columns of `root`; nullopt if a landmark is too near.
template <class Observe>
std::optional<JointDifferences> differences(const Observe& observe, const Eigen::Vector2d& centre,
                                            const Matrix3& root, const Wraps& wraps) {
  JointDifferences found;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto ahead = observe(rule().spread * root.col(k));
    const auto back = observe(-rule().spread * root.col(k));
    if (!ahead || !back) return std::nullopt;
    const Eigen::Vector2d more = models::residual(ahead->value, centre, wraps);
    const Eigen::Vector2d less = models::residual(back->value, centre, wraps);
    found.odd.col(k) = 0.5 * (more - less);
    found.even.col(k) = 0.5 * (more + less);
  }
  return found;
}

}  // namespace

JointGaussian::JointGaussian(const Belief& belief, Retraction retraction, std::size_t room)
    : belief_(belief),
      observation_noise_(deviations_of(belief.sensor, belief).cwiseAbs2().asDiagonal()),
      wraps_(wraps_of(belief.sensor)),
      retraction_(retraction) {
  grow(room);
}

void JointGaussian::grow(std::size_t room) {
  const Eigen::Index wanted = packed(room);
  map_.make_room(wanted);
  seen_.resize(wanted, 2);
  gain_map_.resize(wanted, 4);
  moved_.resize(wanted, 3);
  halved_.resize(wanted, 3);
  map_step_.resize(2, wanted / 2);
}

void JointGaussian::start(const Pose& start, const Eigen::Matrix3d& covariance) {
  pose_ = {start, covariance};
  map_.clear(rows());
  n_landmarks_ = 0;
}

void JointGaussian::replace(const PoseMoments& pose, const MapMoments& map) {
  pose_ = pose;
  map_.take(map, rows());
}

MapMoments& JointGaussian::replace_map(std::size_t n_points) {
  map_.clear(rows());
  if (map_.room() < packed(n_points)) grow(n_points);
  n_landmarks_ = n_points;
  return map_;
}

LinearisedMotion JointGaussian::linearised(const MotionIncrement& motion) const {
  const Direction<double> heading = direction_of(pose_.mean.heading);
  const Point way = in_world(heading, motion.pose().x, motion.pose().y);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << heading.cosine, -heading.sine, heading.sine, heading.cosine;
  return {.mean = {pose_.mean.x + way.x, pose_.mean.y + way.y,
                   wrap(pose_.mean.heading + motion.pose().heading)},
          .by_heading = {-way.y, way.x},
          .noise = turn * symmetric(motion.covariance()) * turn.transpose()};
}

PoseMoments JointGaussian::pose_after(const LinearisedMotion& motion) const {
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F.topRightCorner<2, 1>() = motion.by_heading;
  PoseMoments moved{motion.mean, F * pose_.covariance * F.transpose() + motion.noise};
  mirror_lower(moved.covariance);
  return moved;
}

/// This function is flattened, since it is called at every control step.
[[gnu::flatten]] PoseMoments JointGaussian::pose_after(const MotionIncrement& motion) const {
  return pose_after(linearised(motion));
}

void JointGaussian::move(const LinearisedMotion& motion) {
  map_.cross.col(0).head(rows()) += motion.by_heading(0) * map_.cross.col(2).head(rows());
  map_.cross.col(1).head(rows()) += motion.by_heading(1) * map_.cross.col(2).head(rows());
  pose_ = pose_after(motion);
}

PointMoments JointGaussian::point(std::size_t slot) const {
  const Eigen::Index at = row_of(slot);
  return {map_.mean.segment<2>(at), map_.cross.middleRows<2>(at),
          map_.covariance.block<2, 2>(at, at)};
}

JointGaussian::ObservationStatus JointGaussian::weigh(const PointMoments& landmark,
                                                      const Eigen::Matrix2d& more,
                                                      ExpectedObservation& expected) const {
  const Matrix23& Hx = expected.pose_jacobian;
  const Eigen::Matrix2d& Hf = expected.landmark_jacobian;
  const Eigen::Matrix2d mixed = Hf * landmark.cross * Hx.transpose();
  const auto L = factor(Hx * pose_.covariance * Hx.transpose() + mixed + mixed.transpose() +
                        Hf * landmark.covariance * Hf.transpose() + more + observation_noise_);
  if (!L) return ObservationStatus::faulty;
  expected.factor = *L;
  return ObservationStatus::usable;
}

JointGaussian::ObservationStatus JointGaussian::predict_observation(
    const PointMoments& landmark, ExpectedObservation& expected,
    const std::optional<ObservationPoint>& at) const {
  const auto linearised = [&](const Pose& pose, const Eigen::Vector2d& point) {
    return linearised_detection(belief_.sensor, pose, Point{point.x(), point.y()});
  };
  auto seen = linearised(pose_.mean, landmark.mean);
  if (!seen) return ObservationStatus::too_near;
  expected.observation = seen->value;
  if (at && !(seen = linearised(at->pose, at->landmark))) return ObservationStatus::too_near;
  expected.pose_jacobian = seen->by_pose;
  expected.landmark_jacobian = seen->by_landmark;
  expected.ahead.setZero();
  expected.wraps = wraps_;
  return weigh(landmark, Eigen::Matrix2d::Zero(), expected);
}

void JointGaussian::append(const Eigen::Vector2d& detection, const Eigen::Vector2d& behind) {
  auto placed = placed_landmark(belief_.sensor, pose_.mean, detection);
  expect(placed.has_value(), "a landmark is placed by a detection that does not fix it");
  const Eigen::Matrix2d& Gz = placed->by_detection;
  placed->by_pose.col(2) += quarter_turned(behind);
  append(NewPoint{.mean = placed->point,
                  .by_pose = placed->by_pose,
                  .noise = Gz * observation_noise_ * Gz.transpose()});
}

void JointGaussian::append(const NewPoint& point) {
  if (packed(n_landmarks_ + 1) > map_.room()) grow(std::max<std::size_t>(8, 2 * n_landmarks_));
  put(row_of(n_landmarks_), point);
  ++n_landmarks_;
}

void JointGaussian::replace(std::size_t slot, const NewPoint& point) {
  put(row_of(slot), point);
  mirror_packs(map_.covariance, rows());
}

/// Writes a point to its rows. The point is linear in its arguments, so its covariances are sums of
/// theirs. The rows of `seen_` are its covariances with the existing points.
void JointGaussian::put(Eigen::Index row, const NewPoint& point) {
  const Matrix23& Gx = point.by_pose;
  auto columns = seen_.topRows(rows());
  columns.noalias() = map_.cross.topRows(rows()).lazyProduct(Gx.transpose());
  Matrix23 cross = Gx * pose_.covariance;
  for (const auto& [slot, G] : point.by_points) {
    auto part = gain_map_.leftCols<2>().topRows(rows());
    copy_columns(map_.covariance, row_of(slot), rows(), part);
    columns.noalias() += part.lazyProduct(G.transpose());
    cross += G * map_.cross.middleRows<2>(row_of(slot));
  }
  Eigen::Matrix2d covariance = cross * Gx.transpose() + point.noise;
  for (const auto& [slot, G] : point.by_points) {
    covariance += seen_.middleRows<2>(row_of(slot)).transpose() * G.transpose();
  }
  covariance(0, 1) = covariance(1, 0);
  map_.mean.segment<2>(row) = point.mean;
  map_.cross.middleRows<2>(row) = cross;
  if (row < row_of(n_landmarks_)) {
    write_columns(map_.covariance, row, rows(), columns);
  } else {
    map_.covariance.block(row, 0, 2, row) = columns.topRows(row).transpose();
  }
  mirror_pack(map_.covariance, row);
  map_.covariance.block<2, 2>(row, row) = covariance;
}

Matrix7 JointGaussian::covariance_with(std::size_t first, std::size_t second) const {
  const Eigen::Index a = row_of(first), b = row_of(second);
  Matrix7 P;
  P.topLeftCorner<3, 3>() = pose_.covariance;
  P.block<2, 3>(3, 0) = map_.cross.middleRows<2>(a);
  P.block<2, 3>(5, 0) = map_.cross.middleRows<2>(b);
  P.block<2, 2>(3, 3) = map_.covariance.block<2, 2>(a, a);
  P.block<2, 2>(5, 3) = covariance_of(map_.covariance, b, a);
  P.block<2, 2>(5, 5) = map_.covariance.block<2, 2>(b, b);
  P.triangularView<Eigen::StrictlyUpper>() = P.transpose();
  return P;
}

// The following functions update by a detection.

/// The step of the pose and of the landmark, before any retraction: P H' S^-1 v.
JointGaussian::Step JointGaussian::step_of(std::size_t slot, const ExpectedObservation& expected,
                                           const Eigen::Vector2d& innovation) const {
  const Eigen::Index row = row_of(slot);
  const Eigen::Vector2d weighed =
      inverse_transposed(expected.factor) * expected.factor.whiten(innovation);
  const Eigen::Vector3d pose = expected.pose_jacobian.transpose() * weighed;
  const Eigen::Vector2d landmark = expected.landmark_jacobian.transpose() * weighed;
  const auto mixed = map_.cross.middleRows<2>(row);
  return {pose_.covariance * pose + mixed.transpose() * landmark,
          mixed * pose + map_.covariance.block<2, 2>(row, row) * landmark};
}

/// Linearises again after `step`; the Gaussian still belongs to the estimate before it.
JointGaussian::ObservationStatus JointGaussian::linearise_after(
    const Step& step, std::size_t slot, ExpectedObservation& expected) const {
  const Eigen::Index row = row_of(slot);
  Eigen::Vector2d pose_way = step.pose.head<2>(), landmark_way = step.landmark;
  if (retraction_ == Retraction::right_invariant) {
    const Eigen::Matrix2d V = exponential_jacobian(step.pose(2));
    pose_way = V * pose_way;
    landmark_way = V * landmark_way;
  }
  const Pose& from = pose_.mean;
  const auto at = linearised_detection(
      belief_.sensor, Pose{from.x + pose_way(0), from.y + pose_way(1), from.heading + step.pose(2)},
      Point{map_.mean(row) + landmark_way(0), map_.mean(row + 1) + landmark_way(1)});
  if (!at) return ObservationStatus::too_near;
  ExpectedObservation next{.pose_jacobian = at->by_pose,
                           .landmark_jacobian = at->by_landmark,
                           .observation = at->value,
                           .factor = {},
                           .ahead = {},
                           .wraps = wraps_};
  if (retraction_ ==
      Retraction::right_invariant) {  // the error belongs to the estimate before the step
    next.pose_jacobian.col(2) += next.pose_jacobian.leftCols<2>() * quarter_turned(pose_way) +
                                 next.landmark_jacobian * quarter_turned(landmark_way);
  }
  if (const auto status = weigh(point(slot), Eigen::Matrix2d::Zero(), next);
      status != ObservationStatus::usable)
    return status;
  next.ahead = next.pose_jacobian * step.pose + next.landmark_jacobian * step.landmark;
  expected = next;
  return ObservationStatus::usable;
}

JointGaussian::ObservationStatus JointGaussian::update_with(std::size_t slot,
                                                            const Eigen::Vector2d& detected,
                                                            int iterations,
                                                            ExpectedObservation& expected) {
  Eigen::Vector2d innovation = expected.innovation(detected);
  ObservationStatus status = ObservationStatus::usable;
  for (int i = 0; i < iterations; ++i) {
    status = linearise_after(step_of(slot, expected, innovation), slot, expected);
    if (status != ObservationStatus::usable) break;
    const Eigen::Vector2d before = std::exchange(innovation, expected.innovation(detected));
    if (expected.factor.whiten(innovation - before).norm() < kConverged) break;
  }
  whiten_gain(slot, expected);
  condition(expected.factor.whiten(innovation));
  return status;
}

/// H is one for the position and zero else, for both errors, since the covariance that is kept is
/// that of e.
JointGaussian::ObservationStatus JointGaussian::update_with_fix(const PositionFix& fix,
                                                                double sigma, double& log_density) {
  const auto L =
      factor(pose_.covariance.topLeftCorner<2, 2>() + sigma * sigma * Eigen::Matrix2d::Identity());
  if (!L) return ObservationStatus::faulty;
  const Eigen::Matrix2d white = inverse_transposed(*L);
  gain_pose_ = pose_.covariance.leftCols<2>() * white;
  gain_map_.leftCols<2>().topRows(rows()).noalias() =
      map_.cross.leftCols<2>().topRows(rows()).lazyProduct(white);
  const Eigen::Vector2d innovation = L->whiten(fix - place_of(pose_.mean));
  condition(innovation);
  log_density = log_normal_density(innovation.squaredNorm(), *L, 2.0);
  return ObservationStatus::usable;
}

/// W = P H' L^-T.
void JointGaussian::whiten_gain(std::size_t slot, const ExpectedObservation& expected) {
  const Eigen::Matrix2d inverse = inverse_transposed(expected.factor);
  const Matrix32 pose_white = expected.pose_jacobian.transpose() * inverse;
  const Eigen::Matrix2d landmark_white = expected.landmark_jacobian.transpose() * inverse;
  const Eigen::Index row = row_of(slot);
  copy_columns(map_.covariance, row, rows(), seen_);
  gain_pose_ =
      pose_.covariance * pose_white + map_.cross.middleRows<2>(row).transpose() * landmark_white;
  auto gain = gain_map_.leftCols<2>().topRows(rows());
  gain.noalias() = map_.cross.topRows(rows()).lazyProduct(pose_white);
  gain.noalias() += seen_.topRows(rows()).lazyProduct(landmark_white);
}

/// m <- m + W white, P <- P - W W', and the transformation of the error.
void JointGaussian::condition(const Eigen::Vector2d& white) {
  pose_.covariance -= gain_pose_ * gain_pose_.transpose();
  mirror_lower(pose_.covariance);
  const auto first = gain_map_.col(0).head(rows());
  const auto second = gain_map_.col(1).head(rows());
  for (Eigen::Index j = 0; j < 3; ++j) {
    map_.cross.col(j).head(rows()) -= first * gain_pose_(j, 0) + second * gain_pose_(j, 1);
  }
  const Eigen::Vector2d pose_step = step(white);
  change_map(retraction_ == Retraction::right_invariant && carry_error(pose_step));
  if (retraction_ == Retraction::left_invariant) turn_error(gain_pose_.row(2).dot(white));
}

/// Moves the estimate; returns the displacement of the vehicle.
Eigen::Vector2d JointGaussian::step(const Eigen::Vector2d& white) {
  const Eigen::Vector3d pose_step = gain_pose_ * white;
  Eigen::Vector2d moved = pose_step.head<2>();
  auto map_step = map_step_.reshaped().head(rows());
  map_step = gain_map_.leftCols<2>().topRows(rows()).lazyProduct(white);
  if (retraction_ != Retraction::additive) {
    const Eigen::Matrix2d V = exponential_jacobian(pose_step(2));
    moved = V * moved;
    apply(V, map_step_.leftCols(rows() / 2));
  }
  pose_.mean = {pose_.mean.x + moved(0), pose_.mean.y + moved(1),
                wrap(pose_.mean.heading + pose_step(2))};
  map_.mean.head(rows()) += map_step;
  return moved;
}

/// P <- T P T', T = I + d e_heading' with d = J step (EQUATIONS (15.5)): the covariance, in the map
/// frame, of an invariant error after the estimate moved by `pose_step` and map_step_. The block of
/// the landmarks is P + d c' + c d' + d h d', where c and h are the covariances with the heading.
/// It is left to change_map() as two squares, which are exactly symmetric: P - b b' + a a' with b =
/// c / sqrt(h) and a = b + sqrt(h) d. Neither is larger than P, so that nothing cancels. Returns
/// false if the heading is certain and nothing changes.
bool JointGaussian::carry_error(const Eigen::Vector2d& pose_step) {
  const double variance = pose_.covariance(2, 2);
  if (!(variance > 0.0)) return false;
  const double sigma = std::sqrt(variance);
  const Eigen::Vector2d d = quarter_turned(pose_step);
  apply(quarter_turn(), map_step_.leftCols(rows() / 2));
  const auto map_d = map_step_.reshaped().head(rows());
  const Eigen::Vector3d heading_row = pose_.covariance.row(2).transpose();
  gain_map_.col(2).head(rows()) = map_.cross.col(2).head(rows()) / sigma;
  gain_map_.col(3).head(rows()) = gain_map_.col(2).head(rows()) + sigma * map_d;
  auto cross = map_.cross.topRows(rows());
  cross += map_d.lazyProduct(heading_row.transpose());
  cross.col(0) += d(0) * cross.col(2);
  cross.col(1) += d(1) * cross.col(2);
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  T.topRightCorner<2, 1>() = d;
  pose_.covariance = (T * pose_.covariance * T.transpose()).eval();
  mirror_lower(pose_.covariance);
  return true;
}

/// Turns the covariance of every point by the angle [rad] by which the vehicle has turned: the
/// left-invariant error is in its axes (EQUATIONS (15.20)).
void JointGaussian::turn_error(double angle) {
  const Eigen::Matrix2d R = rotation_by(angle);
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  T.topLeftCorner<2, 2>() = R;
  pose_.covariance = (T * pose_.covariance * T.transpose()).eval();
  mirror_lower(pose_.covariance);
  for (auto cross : map_.cross.colwise()) apply(R, cross.head(rows()).reshaped(2, rows() / 2));
  map_.cross.topRows(rows()) = (map_.cross.topRows(rows()) * T.transpose()).eval();
  for (Eigen::Index j = 0; j < row_of(n_landmarks_); j += 2) {
    const Eigen::Index first = pack_of(j), count = rows() - first;
    auto columns = map_.covariance.block(first, j, count, 2);
    for (auto column : columns.colwise()) apply(R, column.reshaped(2, count / 2));
    columns = (columns * R.transpose()).eval();
  }
  mirror_packs(map_.covariance, rows());
}

/// Let D be the derivative of the points by the pose and C their covariance with it. P <- P - D C'
/// - C D' + D P_x D' = P - D G' - G D' with G = C - D P_x / 2.
void JointGaussian::centre_on_pose() {
  auto D = moved_.topRows(rows()), G = halved_.topRows(rows());
  D.setZero();
  for (std::size_t slot = 0; slot < n_landmarks_; ++slot) {
    const Eigen::Index row = row_of(slot);
    D.middleRows<2>(row) << 1.0, 0.0, pose_.mean.y - map_.mean(row + 1), 0.0, 1.0,
        map_.mean(row) - pose_.mean.x;
  }
  G = map_.cross.topRows(rows());
  G -= D.lazyProduct(0.5 * pose_.covariance);
  for (Eigen::Index j = 0; j < row_of(n_landmarks_); ++j) {
    const Eigen::Index first = pack_of(j), count = rows() - first;
    map_.covariance.col(j).segment(first, count) -=
        D.middleRows(first, count).lazyProduct(G.row(j).transpose()) +
        G.middleRows(first, count).lazyProduct(D.row(j).transpose());
  }
  pose_.covariance.setZero();
  map_.cross.topRows(rows()).setZero();
}

/// Updates the covariance of the landmarks in one pass: P <- P - W W' and, if carry_error() changed
/// it, - b b' + a a'. Whole packs in one order keep it exactly symmetric.
void JointGaussian::change_map(bool carries_error) {
  for (Eigen::Index j = 0; j < row_of(n_landmarks_); ++j) {
    const Eigen::Index first = pack_of(j), count = rows() - first;
    const auto gain = gain_map_.middleRows(first, count);
    auto column = map_.covariance.col(j).segment(first, count);
    if (carries_error) {
      column += gain.col(3) * gain_map_(j, 3) - gain.col(2) * gain_map_(j, 2) -
                gain.col(0) * gain_map_(j, 0) - gain.col(1) * gain_map_(j, 1);
    } else {
      column -= gain.col(0) * gain_map_(j, 0) + gain.col(1) * gain_map_(j, 1);
    }
  }
}

// Regression on sigma points instead of derivatives (EQUATIONS (15.13), (15.14)).

JointGaussian::ObservationStatus JointGaussian::predict_by_sigma_points(
    const PointMoments& landmark, ExpectedObservation& expected) const {
  const Eigen::Vector2d away = landmark.mean - place_of(pose_.mean);
  const Matrix35 T = line_of_sight(away, retraction_);
  Eigen::Matrix<double, 5, 5> P;
  P << pose_.covariance, landmark.cross.transpose(), landmark.cross, landmark.covariance;
  const Eigen::LLT<Matrix3> factor(T * P * T.transpose() + kSmallest * Matrix3::Identity());
  if (factor.info() != Eigen::Success) return ObservationStatus::faulty;
  const Matrix3 root = factor.matrixL();
  const auto observe = [&](const Eigen::Vector3d& step) {
    const Eigen::Vector2d to = retracted(
        away, T.topRightCorner<2, 2>().transpose() * step.head<2>(), step(2), retraction_);
    return linearised_detection(belief_.sensor, Pose{0.0, 0.0, pose_.mean.heading + step(2)},
                                Point{to.x(), to.y()});
  };
  const auto centre = observe(Eigen::Vector3d::Zero());
  if (!centre) return ObservationStatus::too_near;
  const auto found = differences(observe, centre->value, root, wraps_);
  if (!found) return ObservationStatus::too_near;
  const Eigen::Vector2d shift = rule().mean_weight * found->even.rowwise().sum();
  const Eigen::Matrix<double, 3, 2> slope =
      factor.matrixU().solve(found->odd.transpose()) / rule().spread;
  const Eigen::Matrix<double, 2, 5> H = slope.transpose() * T;
  expected = {.pose_jacobian = H.leftCols<3>(),
              .landmark_jacobian = H.rightCols<2>(),
              .observation = centre->value + shift,
              .factor = {},
              .ahead = Eigen::Vector2d::Zero(),
              .wraps = wraps_};
  return weigh(landmark, curvature(found->even, shift), expected);
}

LinearisedMotion JointGaussian::regressed(const MotionIncrement& motion) const {
  LinearisedMotion moved = linearised(motion);
  if (retraction_ != Retraction::additive) return moved;
  const double turn = rule().spread * std::sqrt(pose_.covariance(2, 2));
  if (!(turn > 0.0)) return moved;
  const Eigen::Vector2d way(moved.mean.x - pose_.mean.x, moved.mean.y - pose_.mean.y);
  const Eigen::Vector2d even = (std::cos(turn) - 1.0) * way, shift = rule().mean_weight * even;
  moved.mean.x += shift(0);
  moved.mean.y += shift(1);
  moved.by_heading *= std::sin(turn) / turn;
  moved.noise.topLeftCorner<2, 2>() +=
      rule().symmetric * even * even.transpose() + rule().shift * shift * shift.transpose();
  return moved;
}

}  // namespace montecarta::filters
