// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/delayed_initialisation.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace montecarta::filters {
namespace {

/// Distance [m] from the sensor to the point on a ray; it only affects rounding.
constexpr double kRayLength = 1.0;

/// Derivatives by (pose, first, second), side by side.
Eigen::Matrix<double, 2, 7> stacked(const TriangulatedLandmark& landmark) {
  Eigen::Matrix<double, 2, 7> J;
  J << landmark.by_pose, landmark.by_first, landmark.by_second;
  return J;
}

}  // namespace

DelayedInitialisation::DelayedInitialisation(const Belief& belief)
    : belief_(belief),
      variance_(std::pow(deviations_of(belief.sensor, belief)(0), 2)),
      waiting_(belief.sensor) {}

void DelayedInitialisation::clear() {
  waiting_.clear();
  free_.clear();
}

void DelayedInitialisation::add_points_of(std::int32_t identity,
                                          std::vector<std::uint32_t>& slots) const {
  const Waiting* waiting = waiting_.find(identity);
  if (waiting == nullptr) return;
  if (waiting->kept.points > 0) slots.push_back(waiting->kept.first);
  if (waiting->kept.points > 1) slots.push_back(waiting->kept.second);
}

/// Returns the position of the sensor as a point.
NewPoint DelayedInitialisation::sensor_point(const Pose& pose) const {
  const Mounting& mounting = belief_.sensor.mounting;
  return {.mean = place_of(mounting.pose_of(pose)),
          .by_pose = mounting.jacobian(pose).topRows<2>(),
          .noise = Eigen::Matrix2d::Zero()};
}

/// Returns a point on the ray of a bearing.
NewPoint DelayedInitialisation::ray_point(const Pose& pose, double bearing) const {
  const Direction<double> ray =
      direction_of(belief_.sensor.mounting.pose_of(pose).heading + bearing);
  const Eigen::Vector2d way(kRayLength * ray.cosine, kRayLength * ray.sine);
  const Eigen::Vector2d across(-way.y(), way.x());
  NewPoint point = sensor_point(pose);
  point.mean += way;
  point.by_pose.col(2) += across;
  point.noise = variance_ * across * across.transpose();
  return point;
}

/// Returns the landmark that the kept points and, for bearings, this detection fix.
std::optional<TriangulatedLandmark> DelayedInitialisation::DetectionPair::landmark(
    double side) const {
  const Pose& pose = gaussian.pose().mean;
  const Mounting& mounting = by.belief_.sensor.mounting;
  const Eigen::Vector2d first = gaussian.landmark(kept.first).mean;
  std::optional<TriangulatedLandmark> landmark;
  if (by.waiting_.of_bearings()) {
    landmark = crossing_of_rays(first, gaussian.landmark(kept.second).mean, mounting.pose_of(pose),
                                detection[0], by.variance_);
  } else if (kept.points > 1) {
    landmark = crossing_of_circles(first, gaussian.landmark(kept.second).mean, kept.ranges, side,
                                   by.variance_);
  } else {  // the sensor takes the place of the second point
    landmark = crossing_of_circles(first, place_of(mounting.pose_of(pose)),
                                   {kept.ranges(0), detection[0]}, side, by.variance_);
    if (!landmark) return landmark;
    landmark->by_pose.leftCols<2>() = landmark->by_second;
    landmark->by_second.setZero();
  }
  if (landmark) landmark->by_pose = (landmark->by_pose * mounting.jacobian(pose)).eval();
  return landmark;
}

bool DelayedInitialisation::DetectionPair::cross_well() const {
  const auto at = landmark(1.0);
  if (!at) return false;
  Eigen::Matrix<double, 2, 7> J = stacked(*at);
  J.middleCols<2>(3) -= Eigen::Matrix2d::Identity();  // relative to the first point
  const std::uint32_t second = kept.points > 1 ? kept.second : kept.first;
  const Eigen::Matrix2d spread =
      J * gaussian.covariance_with(kept.first, second) * J.transpose() + at->noise;
  const Eigen::Vector2d here = place_of(by.belief_.sensor.mounting.pose_of(gaussian.pose().mean));
  const double nearest =
      std::min((at->point - gaussian.landmark(kept.first).mean).norm(), (at->point - here).norm());
  return crosses_well(spread, nearest, by.waiting_.of_bearings(), by.variance_);
}

/// D^2 of the detected range if the landmark is on the given side.
double DelayedInitialisation::DetectionPair::squared_distance(double side) const {
  const double never = std::numeric_limits<double>::infinity();
  const auto at = landmark(side);
  if (!at) return never;
  const auto seen = linearised_detection(by.belief_.sensor, gaussian.pose().mean,
                                         Point{at->point.x(), at->point.y()});
  if (!seen) return never;
  Eigen::Matrix<double, 1, 7> J = seen->by_landmark.row(0) * stacked(*at);
  J.leftCols<3>() += seen->by_pose.row(0);
  const Eigen::RowVector2d by_landmark = seen->by_landmark.row(0);
  const Matrix7 P = gaussian.covariance_with(kept.first, kept.second);
  const double S = (J * P * J.transpose()).value() + by.variance_ +
                   (by_landmark * at->noise * by_landmark.transpose()).value();
  return std::pow(detection[0] - seen->value(0), 2) / S;
}

bool DelayedInitialisation::can_advance(const CompressedGaussian& gaussian,
                                        const Detection& detection) {
  Waiting& waiting = waiting_.entry(detection.identity);
  return waiting_.can_advance(waiting, DetectionPair{*this, gaussian, waiting.kept, detection});
}

/// Adds a point, or reuses a free one, and returns its slot.
std::uint32_t DelayedInitialisation::add(CompressedGaussian& gaussian, const NewPoint& point) {
  if (free_.empty()) {
    gaussian.append(point);
    return static_cast<std::uint32_t>(gaussian.landmarks() - 1);
  }
  const std::uint32_t slot = free_.back();
  free_.pop_back();
  gaussian.make_near({&slot, 1});
  gaussian.replace(slot, point);
  return slot;
}

/// Keeps at most two points. A first bearing gives both, and finish() uses the second bearing
/// directly.
void DelayedInitialisation::keep(CompressedGaussian& gaussian, Kept& kept,
                                 const Detection& detection) {
  if (kept.points > 1) return;
  const Pose pose = gaussian.pose().mean;
  kept.ranges(static_cast<Eigen::Index>(kept.points)) = detection[0];
  (kept.points == 0 ? kept.first : kept.second) = add(gaussian, sensor_point(pose));
  ++kept.points;
  if (!waiting_.of_bearings()) return;
  kept.second = add(gaussian, ray_point(pose, detection[0]));
  ++kept.points;
}

std::uint32_t DelayedInitialisation::finish(CompressedGaussian& gaussian, Waiting& waiting,
                                            const Detection& detection) {
  const Kept kept = waiting.kept;
  const auto landmark = DetectionPair{*this, gaussian, kept, detection}.landmark(waiting.side);
  expect(landmark.has_value(),
         "a landmark is initialised whose lines of sight or circles do not cross");
  const std::array slots{kept.first, kept.second};
  gaussian.make_near(slots);  // another landmark of this scan may have made them far
  std::array<NewPoint::Part, 2> parts = {
      {{kept.first, landmark->by_first}, {kept.second, landmark->by_second}}};
  gaussian.replace(kept.second, {.mean = landmark->point,
                                 .by_pose = landmark->by_pose,
                                 .noise = landmark->noise,
                                 .by_points = parts});
  free_.push_back(kept.first);
  waiting_.remove(waiting);
  return kept.second;
}

std::optional<std::uint32_t> DelayedInitialisation::advance(CompressedGaussian& gaussian,
                                                            const Detection& detection) {
  Waiting& waiting = waiting_.entry(detection.identity);
  if (!waiting_.advance(waiting, [&] { keep(gaussian, waiting.kept, detection); }))
    return std::nullopt;
  return finish(gaussian, waiting, detection);
}

}  // namespace montecarta::filters
