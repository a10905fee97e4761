// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/two_sightings.hpp"

#include "filters/models/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::filters {
namespace {

Eigen::Vector2d point_of(const Sighting& sighting) { return place_of(sighting.sensor); }

Crossing crossing_of(const TriangulatedLandmark& landmark) {
  return {landmark.point, landmark.noise};
}

}  // namespace

TwoSightings::TwoSightings(const Sensor& sensor, double variance)
    : sensor_{sensor.kind, {}},
      variance_(variance),
      of_bearings_(components_of(sensor)[0] == Quantity::bearing) {}

std::optional<Crossing> TwoSightings::crossing(const Sighting& first, const Sighting& second,
                                               double side) const {
  const Eigen::Vector2d here = point_of(first);
  if (!of_bearings_) {
    const auto landmark =
        crossing_of_circles(here, point_of(second), {first.value, second.value}, side, variance_);
    return landmark ? std::optional(crossing_of(*landmark)) : std::nullopt;
  }
  const Direction<double> d = direction_of(first.sensor.heading + first.value);
  const Eigen::Vector2d ray(d.cosine, d.sine), across(-d.sine, d.cosine);
  const auto landmark = crossing_of_rays(here, here + ray, second.sensor, second.value, variance_);
  if (!landmark) return std::nullopt;
  Crossing crossing = crossing_of(*landmark);
  const Eigen::Vector2d by_first = landmark->by_second * across;
  crossing.covariance += variance_ * by_first * by_first.transpose();
  return crossing;
}

bool TwoSightings::cross_well(const Sighting& first, const Sighting& second) const {
  const auto at = crossing(first, second, 1.0);
  if (!at) return false;
  const double nearest =
      std::min((at->point - point_of(first)).norm(), (at->point - point_of(second)).norm());
  return crosses_well(at->covariance, nearest, of_bearings_, variance_);
}

double TwoSightings::squared_distance(const Sighting& first, const Sighting& second, double side,
                                      const Sighting& third) const {
  const double never = std::numeric_limits<double>::infinity();
  const auto at = crossing(first, second, side);
  if (!at) return never;
  const auto seen =
      linearised_detection(sensor_, third.sensor, Point{at->point.x(), at->point.y()});
  if (!seen) return never;
  const Eigen::RowVector2d H = seen->by_landmark.row(0);
  const double S = (H * at->covariance * H.transpose()).value() + variance_;
  return std::pow(residual({third.value, 0.0}, seen->value, wraps_of(sensor_))(0), 2) / S;
}

}  // namespace montecarta::filters
