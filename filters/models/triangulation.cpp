// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::models {

std::optional<TriangulatedLandmark> crossing_of_rays(const Eigen::Vector2d& first,
                                                     const Eigen::Vector2d& second,
                                                     const Pose& sensor, double bearing,
                                                     double variance) {
  const double length = (second - first).norm();
  const Eigen::Vector2d u = (second - first) / length;
  const Direction<double> sight = direction_of(sensor.heading + bearing);
  const Eigen::Vector2d w(sight.cosine, sight.sine);
  const Eigen::Vector2d between = place_of(sensor) - first;
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
  };
  const double sine = cross(u, w);
  const double along_first = cross(between, w) / sine, along_second = cross(between, u) / sine;
  if (!(along_first > 0.0 && along_second > 0.0 && std::isfinite(along_first + along_second)))
    return std::nullopt;
  // n'(f - first) = 0 and m'(f - sensor) = 0, with n and m across the rays.
  const Eigen::RowVector2d n(-u.y(), u.x()), m(-w.y(), w.x());
  const Eigen::Vector2d by_n = w / sine, by_m = -u / sine;
  TriangulatedLandmark landmark{first + along_first * u, {}, {}, {}, {}};
  landmark.by_first = by_n * n * (1.0 - along_first / length);
  landmark.by_second = by_n * n * (along_first / length);
  landmark.by_pose << by_m * m, by_m * along_second;
  landmark.noise = variance * along_second * along_second * by_m * by_m.transpose();
  return landmark;
}

std::optional<TriangulatedLandmark> crossing_of_circles(const Eigen::Vector2d& first,
                                                        const Eigen::Vector2d& second,
                                                        const Eigen::Vector2d& ranges, double side,
                                                        double variance) {
  const double apart = (second - first).norm();
  const double along = 0.5 * (apart + (ranges(0) - ranges(1)) * (ranges(0) + ranges(1)) / apart);
  const double across_squared = ranges(0) * ranges(0) - along * along;
  if (!(apart > 0.0 && across_squared > 0.0)) return std::nullopt;
  const Eigen::Vector2d way = (second - first) / apart;
  const Eigen::Vector2d across(-way.y(), way.x());
  const Eigen::Vector2d point = first + along * way + side * std::sqrt(across_squared) * across;
  // u'(f - first) = range of the first, w'(f - second) = that of the second.
  const Eigen::Vector2d u = (point - first) / ranges(0), w = (point - second) / ranges(1);
  const double sine = u.x() * w.y() - u.y() * w.x();
  const Eigen::Vector2d by_u = Eigen::Vector2d(w.y(), -w.x()) / sine;
  const Eigen::Vector2d by_w = Eigen::Vector2d(-u.y(), u.x()) / sine;
  return TriangulatedLandmark{point, by_u * u.transpose(), by_w * w.transpose(), Matrix23::Zero(),
                              variance * (by_u * by_u.transpose() + by_w * by_w.transpose())};
}

bool crosses_well(const Eigen::Matrix2d& covariance, double nearest, bool of_bearings,
                  double variance) {
  // Greatest ratio of standard deviation to distance, for which terms of second order are small.
  constexpr double kMostRelative = 0.1;
  // For ranges, an error across the line of sight changes the range by at most this share of its
  // standard deviation; in first order it does not change it.
  constexpr double kMostCurvature = 0.25;
  const double half_sum = 0.5 * covariance.trace();
  const double half_difference = 0.5 * (covariance(0, 0) - covariance(1, 1));
  const double largest = half_sum + length(half_difference, covariance(0, 1));
  if (!(std::sqrt(largest) <= kMostRelative * nearest)) return false;
  return of_bearings || largest / (2.0 * nearest) <= kMostCurvature * std::sqrt(variance);
}

std::optional<double> chosen_side(double left, double right) {
  constexpr double kFits = 9.0, kFitsBetter = 25.0;
  if (std::min(left, right) > kFits || std::abs(left - right) < kFitsBetter) return std::nullopt;
  return left < right ? 1.0 : -1.0;
}

bool is_of_bearings(const Sensor& sensor) { return components_of(sensor)[0] == Quantity::bearing; }

TwoSightings::TwoSightings(const Sensor& sensor, double variance)
    : sensor_{sensor.kind, {}}, variance_(variance), of_bearings_(is_of_bearings(sensor)) {}

std::optional<Crossing> TwoSightings::crossing(const Sighting& first, const Sighting& second,
                                               double side) const {
  const Eigen::Vector2d here = place_of(first.sensor);
  if (!of_bearings_) {
    const auto landmark = crossing_of_circles(here, place_of(second.sensor),
                                              {first.value, second.value}, side, variance_);
    return landmark ? std::optional(Crossing{landmark->point, landmark->noise}) : std::nullopt;
  }
  const Direction<double> d = direction_of(first.sensor.heading + first.value);
  const Eigen::Vector2d ray(d.cosine, d.sine), across(-d.sine, d.cosine);
  const auto landmark = crossing_of_rays(here, here + ray, second.sensor, second.value, variance_);
  if (!landmark) return std::nullopt;
  Crossing crossing{landmark->point, landmark->noise};
  const Eigen::Vector2d by_first = landmark->by_second * across;
  crossing.covariance += variance_ * by_first * by_first.transpose();
  return crossing;
}

bool TwoSightings::cross_well(const Sighting& first, const Sighting& second) const {
  const auto at = crossing(first, second, 1.0);
  if (!at) return false;
  const double nearest = std::min((at->point - place_of(first.sensor)).norm(),
                                  (at->point - place_of(second.sensor)).norm());
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

}  // namespace montecarta::models
