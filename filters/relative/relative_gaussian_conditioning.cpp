// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/sensor_kinds.hpp"
#include "filters/relative/relative_gaussian.hpp"

#include <algorithm>
#include <tuple>

// What a RelativeGaussian expects of detections, and how it is conditioned.

namespace montecarta::filters {
namespace {

using Point = RelativeChain::Point;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Newest frame first; within a frame in one order, so that sums have one.
void sort_parts(LinearisedPairs& pairs) {
  using Part = LinearisedPairs::Part;
  std::ranges::sort(pairs.parts, [](const Part& a, const Part& b) {
    return std::tie(b.frame, a.pair, a.row) < std::tie(a.frame, b.pair, b.row);
  });
}

/// A landmark in the frame of the vehicle; `sign` of its derivatives.
Eigen::Vector2d add_place(const Point& point, const Eigen::VectorXd& mean,
                          const VehicleInFrames& vehicle, Eigen::Index pair, double sign,
                          LinearisedPairs& pairs) {
  const LinearisedPoint at = linearised_point(point, mean);
  const LinearisedDetection seen =
      PositionSensor::linearised(vehicle.in(point.frame), at.place).value();
  pairs.parts.push_back({pair, point.frame, point.row, sign * seen.by_pose,
                         sign * seen.by_landmark * at.by_coordinates});
  return seen.value;
}

}  // namespace

RelativeOutcome RelativeGaussian::see(std::span<const Seen> scan, int iterations) {
  std::size_t oldest = chain_.newest_frame();
  for (const Seen& seen : scan) oldest = std::min(oldest, point(seen.landmark).frame);
  VehicleInFrames& now = scratch_.conditioning.vehicle;
  now.linearise(chain_, mean_, oldest);
  std::vector<Seen>& used = scratch_.used;
  used.clear();
  for (const Seen& seen : scan) {
    const Point& p = point(seen.landmark);
    const LinearisedPoint at = linearised_point(p, mean_);
    if (!too_near(predicted_observation(now.in(p.frame), at.place))) used.push_back(seen);
  }
  if (used.empty()) return {};
  const Eigen::Vector2d variances(noise_.range, noise_.bearing);
  const RelativeMeasurement measurement{
      .oldest_frame = oldest,
      .linearise = [&](const Eigen::VectorXd& mean, const VehicleInFrames& vehicle,
                       LinearisedPairs& pairs) { return linearise(used, mean, vehicle, pairs); },
      .variances = variances.replicate(static_cast<Eigen::Index>(used.size()), 1)};
  return condition(chain_, measurement, iterations, scratch_.conditioning, mean_, P_);
}

bool RelativeGaussian::linearise(std::span<const Seen> scan, const Eigen::VectorXd& mean,
                                 const VehicleInFrames& vehicle, LinearisedPairs& pairs) const {
  pairs.parts.clear();
  pairs.residual.resize(2 * static_cast<Eigen::Index>(scan.size()));
  Eigen::Index pair = 0;
  for (const Seen& seen : scan) {
    const Point& p = point(seen.landmark);
    const LinearisedPoint at = linearised_point(p, mean);
    const auto expected = linearised_observation(vehicle.in(p.frame), at.place);
    if (too_near(expected.observation)) return false;
    pairs.residual.segment<2>(2 * pair) = to_vector(residual(seen.observed, expected.observation));
    pairs.parts.push_back({pair++, p.frame, p.row, pose_jacobian(expected),
                           landmark_jacobian(expected) * at.by_coordinates});
  }
  sort_parts(pairs);
  return true;
}

bool RelativeGaussian::equate(int iterations) {
  auto& twice = scratch_.twice;
  twice.clear();
  std::size_t oldest = chain_.newest_frame();
  for (const auto& [first, again] : chain_.landmarks) {
    if (!again) continue;
    twice.emplace_back(first, *again);
    oldest = std::min(oldest, first.frame);
  }
  const auto linearise = [&](const Eigen::VectorXd& mean, const VehicleInFrames& vehicle,
                             LinearisedPairs& pairs) {
    pairs.parts.clear();
    pairs.residual.resize(2 * static_cast<Eigen::Index>(twice.size()));
    Eigen::Index pair = 0;
    for (const auto& [first, again] : twice) {
      const Eigen::Vector2d then = add_place(first, mean, vehicle, pair, 1.0, pairs);
      const Eigen::Vector2d now = add_place(again, mean, vehicle, pair, -1.0, pairs);
      pairs.residual.segment<2>(2 * pair++) = now - then;
    }
    sort_parts(pairs);
    return true;
  };
  const RelativeMeasurement measurement{
      .oldest_frame = oldest, .linearise = linearise, .variances = {}};
  return !condition(chain_, measurement, iterations, scratch_.conditioning, mean_, P_).is_faulty;
}

bool RelativeGaussian::join(int iterations) {
  const bool are_equal = equate(iterations);
  scratch_.is_kept.assign(static_cast<std::size_t>(rows_), true);
  for (auto& [first, again] : chain_.landmarks) {
    if (!again) continue;
    if (!are_equal) std::swap(first, *again);
    std::fill_n(scratch_.is_kept.begin() + again->row, 2, false);
    again.reset();
  }
  keep_rows();
  return are_equal;
}

void RelativeGaussian::expect_all(const Expect& expect) const {
  VehicleGaussian vehicle{.with_all = Columns::Zero(P_.rows(), 3)};
  for (std::size_t k = chain_.displacements.size(); k-- > 0;) {
    vehicle.become_that_in_frame(k, chain_, mean_, P_);
    for (std::size_t l = 0; l < chain_.landmarks.size(); ++l) {
      if (point(l).frame == k) expect_one(l, vehicle, expect);
    }
  }
}

void RelativeGaussian::expect_one(std::size_t landmark, const VehicleGaussian& vehicle,
                                  const Expect& expect) const {
  const Point& p = point(landmark);
  const LinearisedPoint at = linearised_point(p, mean_);
  const auto seen = linearised_observation(vehicle.pose, at.place);
  if (too_near(seen.observation)) return;
  const Matrix23 Hx = pose_jacobian(seen);
  const Eigen::Matrix2d Hl = landmark_jacobian(seen) * at.by_coordinates;
  const Eigen::Matrix2d mixed = Hl * vehicle.with_all.middleRows<2>(p.row) * Hx.transpose();
  Eigen::Matrix2d S = Hx * vehicle.covariance * Hx.transpose() + mixed + mixed.transpose() +
                      Hl * P_.block<2, 2>(p.row, p.row) * Hl.transpose();
  S.diagonal() += Eigen::Vector2d(noise_.range, noise_.bearing);
  expect(landmark, seen.observation, S);
}

}  // namespace montecarta::filters
