// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/relative_gaussian.hpp"

#include <algorithm>
#include <functional>
#include <utility>

// What a RelativeGaussian expects of detections, and how it is conditioned.

namespace montecarta::filters {
namespace {

using Point = RelativeChain::Point;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Newest frame first; within a frame as given, so that sums have one order.
void sort_parts(LinearisedPairs& pairs) {
  std::ranges::stable_sort(pairs.parts, std::greater(), &LinearisedPairs::Part::frame);
}

/// A landmark in the frame of the vehicle; `sign` of its derivatives.
Eigen::Vector2d add_place(const Point& point, const Eigen::VectorXd& mean,
                          const VehicleInFrames& vehicle, Eigen::Index pair, double sign,
                          LinearisedPairs& pairs) {
  const Pose& pose = vehicle.in(point.frame);
  const LinearisedPoint at = linearised_point(point, mean);
  const Pose place = relative_to(pose, {at.place.x, at.place.y, 0.0});
  const Direction<double> d = direction_of(pose.heading);
  Eigen::Matrix2d R;
  R << d.cosine, d.sine, -d.sine, d.cosine;
  Matrix23 by_pose;
  by_pose << -R, Eigen::Vector2d(place.y, -place.x);
  pairs.parts.push_back(
      {pair, point.frame, point.row, sign * by_pose, sign * R * at.by_coordinates});
  return {place.x, place.y};
}

}  // namespace

RelativeOutcome RelativeGaussian::see(std::span<const Seen> scan, int iterations) {
  std::vector<Seen> used;
  std::size_t oldest = chain_.newest_frame();
  for (const Seen& seen : scan) oldest = std::min(oldest, point(seen.landmark).frame);
  const auto linearise = [&](const Eigen::VectorXd& mean, const VehicleInFrames& vehicle,
                             LinearisedPairs& pairs) {
    pairs.parts.clear();
    pairs.residual.resize(2 * static_cast<Eigen::Index>(used.size()));
    Eigen::Index pair = 0;
    for (const Seen& seen : used) {
      const Point& p = point(seen.landmark);
      const LinearisedPoint at = linearised_point(p, mean);
      const auto expected = linearised_observation(vehicle.in(p.frame), at.place);
      if (too_near(expected.observation)) return false;
      pairs.residual.segment<2>(2 * pair) =
          to_vector(residual(seen.observed, expected.observation));
      pairs.parts.push_back({pair++, p.frame, p.row, pose_jacobian(expected),
                             landmark_jacobian(expected) * at.by_coordinates});
    }
    sort_parts(pairs);
    return true;
  };
  VehicleInFrames vehicle;
  vehicle.linearise(chain_, mean_, oldest);
  for (const Seen& seen : scan) {
    const Point& p = point(seen.landmark);
    const LinearisedPoint at = linearised_point(p, mean_);
    if (!too_near(predicted_observation(vehicle.in(p.frame), at.place))) used.push_back(seen);
  }
  if (used.empty()) return {};
  const Eigen::Vector2d variances(noise_.range, noise_.bearing);
  return condition(chain_,
                   {.oldest_frame = oldest,
                    .linearise = linearise,
                    .variances = variances.replicate(static_cast<Eigen::Index>(used.size()), 1)},
                   iterations, mean_, P_);
}

RelativeOutcome RelativeGaussian::join(int iterations) {
  std::vector<std::pair<Point, Point>> twice;
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
      const Eigen::Vector2d apart = add_place(first, mean, vehicle, pair, 1.0, pairs) -
                                    add_place(again, mean, vehicle, pair, -1.0, pairs);
      pairs.residual.segment<2>(2 * pair++) = -apart;
    }
    sort_parts(pairs);
    return true;
  };
  const RelativeOutcome outcome =
      condition(chain_, {.oldest_frame = oldest, .linearise = linearise, .variances = {}},
                iterations, mean_, P_);
  std::vector<char> is_kept(static_cast<std::size_t>(mean_.size()), true);
  for (auto& [first, again] : chain_.landmarks) {
    if (!again) continue;
    if (outcome.is_faulty) std::swap(first, *again);
    is_kept[static_cast<std::size_t>(again->row)] = false;
    is_kept[static_cast<std::size_t>(again->row + 1)] = false;
    again.reset();
  }
  keep_rows(is_kept);
  return outcome;
}

/// The covariance of the vehicle's pose in a frame, of which there are many, follows from that in
/// the next newer one.
void RelativeGaussian::expect_all(const std::function<void(std::size_t, const RangeBearing<double>&,
                                                           const Eigen::Matrix2d&)>& expect) const {
  const Eigen::Vector2d variances(noise_.range, noise_.bearing);
  Pose vehicle{};
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
  Columns with_pose = Columns::Zero(P_.rows(), 3);
  for (std::size_t k = chain_.displacements.size(); k-- > 0;) {
    const auto step = linearised_composition(displacement(chain_, k, mean_), vehicle);
    const Eigen::Index d = chain_.displacements[k];
    const Eigen::Matrix3d cross =
        step.by_first * with_pose.middleRows<3>(d) * step.by_second.transpose();
    C = (step.by_second * C * step.by_second.transpose() + cross + cross.transpose() +
         step.by_first * P_.block<3, 3>(d, d) * step.by_first.transpose())
            .eval();
    with_pose = (with_pose.lazyProduct(step.by_second.transpose()) +
                 P_.middleCols<3>(d).lazyProduct(step.by_first.transpose()))
                    .eval();
    vehicle = step.pose;
    for (std::size_t l = 0; l < chain_.landmarks.size(); ++l) {
      const Point& p = point(l);
      if (p.frame != k) continue;
      const LinearisedPoint at = linearised_point(p, mean_);
      const auto seen = linearised_observation(vehicle, at.place);
      if (too_near(seen.observation)) continue;
      const Matrix23 Hx = pose_jacobian(seen);
      const Eigen::Matrix2d Hl = landmark_jacobian(seen) * at.by_coordinates;
      const Eigen::Matrix2d mixed = Hl * with_pose.middleRows<2>(p.row) * Hx.transpose();
      Eigen::Matrix2d S = Hx * C * Hx.transpose() + mixed + mixed.transpose() +
                          Hl * P_.block<2, 2>(p.row, p.row) * Hl.transpose();
      S.diagonal() += variances;
      expect(l, seen.observation, S);
    }
  }
}

}  // namespace montecarta::filters
