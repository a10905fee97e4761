// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/delayed_initialisation.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace montecarta::filters {
namespace {

/// [m] of the point on a ray from the sensor; no result depends on it but by rounding.
constexpr double kRayLength = 1.0;

/// Derivatives by (pose, first, second) side by side.
Eigen::Matrix<double, 2, 7> stacked(const TriangulatedLandmark& landmark) {
  Eigen::Matrix<double, 2, 7> J;
  J << landmark.by_pose, landmark.by_first, landmark.by_second;
  return J;
}

}  // namespace

DelayedInitialisation::DelayedInitialisation(const Belief& belief)
    : belief_(belief), variance_(std::pow(deviations_of(belief.sensor, belief)(0), 2)) {}

void DelayedInitialisation::clear() {
  waiting_.clear();
  free_.clear();
}

const DelayedInitialisation::Waiting* DelayedInitialisation::find(std::int32_t identity) const {
  const auto found = std::ranges::find(waiting_, identity, &Waiting::identity);
  return found == waiting_.end() ? nullptr : &*found;
}

DelayedInitialisation::Waiting& DelayedInitialisation::entry(std::int32_t identity) {
  const auto found = std::ranges::find(waiting_, identity, &Waiting::identity);
  return found == waiting_.end() ? waiting_.emplace_back(Waiting{.identity = identity}) : *found;
}

void DelayedInitialisation::add_points_of(std::int32_t identity,
                                          std::vector<std::uint32_t>& slots) const {
  const Waiting* waiting = find(identity);
  if (waiting == nullptr) return;
  slots.push_back(waiting->first);
  if (is_bearing() || waiting->stage == Stage::ambiguous) slots.push_back(waiting->second);
}

/// The place of the sensor.
NewPoint DelayedInitialisation::sensor_point(const Pose& pose) const {
  const Mounting& mounting = belief_.sensor.mounting;
  return {.mean = place_of(mounting.pose_of(pose)),
          .by_pose = mounting.jacobian(pose).topRows<2>(),
          .noise = Eigen::Matrix2d::Zero()};
}

/// A point on the ray that the sensor sees.
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

/// The landmark as the kept points and, of bearings, this detection place it.
std::optional<TriangulatedLandmark> DelayedInitialisation::triangulated(
    const CompressedGaussian& gaussian, const Waiting& waiting, const Detection& detection,
    double side) const {
  const Pose& pose = gaussian.pose().mean;
  const Mounting& mounting = belief_.sensor.mounting;
  const Eigen::Vector2d first = gaussian.landmark(waiting.first).mean;
  std::optional<TriangulatedLandmark> landmark;
  if (is_bearing()) {
    landmark = crossing_of_rays(first, gaussian.landmark(waiting.second).mean,
                                mounting.pose_of(pose), detection[0], variance_);
  } else if (waiting.stage == Stage::ambiguous) {
    landmark = crossing_of_circles(first, gaussian.landmark(waiting.second).mean, waiting.ranges,
                                   side, variance_);
  } else {  // as if the sensor were the second point
    landmark = crossing_of_circles(first, place_of(mounting.pose_of(pose)),
                                   {waiting.ranges(0), detection[0]}, side, variance_);
    if (!landmark) return landmark;
    landmark->by_pose.leftCols<2>() = landmark->by_second;
    landmark->by_second.setZero();
  }
  if (landmark) landmark->by_pose = (landmark->by_pose * mounting.jacobian(pose)).eval();
  return landmark;
}

bool DelayedInitialisation::crosses_well(const CompressedGaussian& gaussian, const Waiting& waiting,
                                         const Detection& detection) const {
  const auto landmark = triangulated(gaussian, waiting, detection, 1.0);
  if (!landmark) return false;
  Eigen::Matrix<double, 2, 7> J = stacked(*landmark);
  J.middleCols<2>(3) -= Eigen::Matrix2d::Identity();  // from the first point
  const std::uint32_t second = is_bearing() ? waiting.second : waiting.first;
  const Eigen::Matrix2d spread =
      J * gaussian.covariance_with(waiting.first, second) * J.transpose() + landmark->noise;
  const Eigen::Vector2d here = place_of(belief_.sensor.mounting.pose_of(gaussian.pose().mean));
  const double nearest = std::min((landmark->point - gaussian.landmark(waiting.first).mean).norm(),
                                  (landmark->point - here).norm());
  return models::crosses_well(spread, nearest, is_bearing(), variance_);
}

/// D^2 of a range, were the landmark on that side.
double DelayedInitialisation::squared_distance(const CompressedGaussian& gaussian,
                                               const Waiting& waiting, const Detection& detection,
                                               double side) const {
  const double never = std::numeric_limits<double>::infinity();
  const auto landmark = triangulated(gaussian, waiting, detection, side);
  if (!landmark) return never;
  const auto seen = linearised_detection(belief_.sensor, gaussian.pose().mean,
                                         Point{landmark->point.x(), landmark->point.y()});
  if (!seen) return never;
  Eigen::Matrix<double, 1, 7> J = seen->by_landmark.row(0) * stacked(*landmark);
  J.leftCols<3>() += seen->by_pose.row(0);
  const Eigen::RowVector2d by_landmark = seen->by_landmark.row(0);
  const Matrix7 P = gaussian.covariance_with(waiting.first, waiting.second);
  const double S = (J * P * J.transpose()).value() + variance_ +
                   (by_landmark * landmark->noise * by_landmark.transpose()).value();
  return std::pow(detection[0] - seen->value(0), 2) / S;
}

std::optional<double> DelayedInitialisation::decided_side(const CompressedGaussian& gaussian,
                                                          const Waiting& waiting,
                                                          const Detection& detection) const {
  return chosen_side(squared_distance(gaussian, waiting, detection, 1.0),
                     squared_distance(gaussian, waiting, detection, -1.0));
}

bool DelayedInitialisation::advances(const CompressedGaussian& gaussian,
                                     const Detection& detection) {
  const Waiting* waiting = find(detection.identity);
  if (waiting == nullptr) return true;
  switch (waiting->stage) {
    case Stage::unseen:
      return true;
    case Stage::seen:
      return crosses_well(gaussian, *waiting, detection);
    case Stage::crossing:
      return triangulated(gaussian, *waiting, detection, 1.0).has_value();
    case Stage::ambiguous: {
      const auto side = decided_side(gaussian, *waiting, detection);
      entry(detection.identity).side = side.value_or(1.0);
      return side.has_value();
    }
  }
  return false;
}

/// In the place of a point that nothing is kept in, if there is one.
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

std::uint32_t DelayedInitialisation::finish(CompressedGaussian& gaussian, Waiting& waiting,
                                            const Detection& detection) {
  const auto landmark = triangulated(gaussian, waiting, detection, waiting.side);
  expect(landmark.has_value(),
         "a landmark is initialised whose lines of sight or circles do not cross");
  const std::array slots{waiting.first, waiting.second};
  gaussian.make_near(slots);  // another landmark of this scan may have made them far
  std::array<NewPoint::Part, 2> parts = {
      {{waiting.first, landmark->by_first}, {waiting.second, landmark->by_second}}};
  gaussian.replace(waiting.second, {.mean = landmark->point,
                                    .by_pose = landmark->by_pose,
                                    .noise = landmark->noise,
                                    .by_points = parts});
  free_.push_back(waiting.first);
  const std::uint32_t slot = waiting.second;
  std::swap(waiting, waiting_.back());
  waiting_.pop_back();
  return slot;
}

std::optional<std::uint32_t> DelayedInitialisation::advance(CompressedGaussian& gaussian,
                                                            const Detection& detection) {
  Waiting& waiting = entry(detection.identity);
  const Pose pose = gaussian.pose().mean;
  switch (waiting.stage) {
    case Stage::unseen:
      waiting.stage = Stage::seen;
      waiting.first = add(gaussian, sensor_point(pose));
      waiting.ranges(0) = detection[0];
      if (is_bearing()) waiting.second = add(gaussian, ray_point(pose, detection[0]));
      return std::nullopt;
    case Stage::seen:
      waiting.stage = Stage::crossing;
      return std::nullopt;
    case Stage::crossing:
      if (is_bearing()) return finish(gaussian, waiting, detection);
      waiting.stage = Stage::ambiguous;
      waiting.second = add(gaussian, sensor_point(pose));
      waiting.ranges(1) = detection[0];
      return std::nullopt;
    case Stage::ambiguous:
      return finish(gaussian, waiting, detection);
  }
  return std::nullopt;
}

}  // namespace montecarta::filters
