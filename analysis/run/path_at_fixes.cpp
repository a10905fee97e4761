// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/path_at_fixes.hpp"

#include <algorithm>

namespace montecarta::analysis {
namespace {

Pose pose_at(std::span<const double> path, std::size_t row) {
  return {path[3 * row], path[3 * row + 1], path[3 * row + 2]};
}

Pose between(const Pose& before, const Pose& after, double share) {
  const Eigen::Vector3d way = share * boxminus(after, before);
  return {before.x + way(0), before.y + way(1), wrap(before.heading + way(2))};
}

bool are_same(const Eigen::Vector2d& position, const Pose& start) {
  constexpr double kSame = 1e-6;  // [m] largest distance at which two positions count as equal
  return (position - Eigen::Vector2d(start.x, start.y)).norm() < kSame;
}

/// Returns whether an estimate exists at a time [s] between row `next` and the one before.
bool is_estimated(double time, std::span<const double> times, std::size_t next) {
  const double before = next == 0 ? 0.0 : times[next - 1], after = times[next];
  return after - before <= kLongestGap + kTimeAtPose ||
         std::min(time - before, after - time) <= kTimeAtPose;
}

}  // namespace

PathAtFixes::PathAtFixes(const ReferencePath& reference, std::span<const double> times,
                         const Pose& start, const Eigen::Matrix3d& start_covariance)
    : start_(start),
      start_covariance_(start_covariance),
      has_errors_(!reference.covariance.empty()) {
  used_.name = reference.name;
  for (std::size_t f = 0; f < reference.time.size(); ++f) {
    const double time = reference.time[f];
    if (times.empty() || !(time >= 0.0 && time <= times.back())) {
      ++outside_;
      continue;
    }
    const bool is_first = places_.empty() && in_gaps_ == 0;
    if (is_first) has_start_ = are_same(reference.position[f], start);
    const FixPlace place = place_of(time, times);
    if (!is_estimated(time, times, place.next)) {
      ++in_gaps_;
      continue;
    }
    used_.time.push_back(time);
    used_.position.push_back(reference.position[f]);
    if (!reference.heading.empty()) used_.heading.push_back(reference.heading[f]);
    if (!reference.covariance.empty()) used_.covariance.push_back(reference.covariance[f]);
    places_.push_back(place);
  }
}

PathAtFixes::FixPlace PathAtFixes::place_of(double time, std::span<const double> times) {
  const auto next = std::ranges::lower_bound(times, time);
  const double before = next == times.begin() ? 0.0 : *(next - 1);
  const double length = *next - before;
  return {static_cast<std::size_t>(next - times.begin()),
          length > 0.0 ? (time - before) / length : 1.0};
}

std::vector<Pose> PathAtFixes::interpolate(std::span<const double> path) const {
  std::vector<Pose> poses;
  poses.reserve(places_.size());
  for (const FixPlace& place : places_) {
    const Pose before = place.next == 0 ? start_ : pose_at(path, place.next - 1);
    poses.push_back(between(before, pose_at(path, place.next), place.share));
  }
  return poses;
}

}  // namespace montecarta::analysis
