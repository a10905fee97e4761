// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/gauss_newton.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace montecarta::filters {
namespace {

constexpr int kMostSteps = 20;
constexpr int kMostStepHalvings = 10;
/// An increase of the sum by less than this share is due to rounding.
constexpr double kCostRounding = 1e-12;

}  // namespace

bool GaussNewton::solve(const FactorGraph& graph, double tolerance, GraphEstimate& estimate) {
  given_ = estimate;
  double now = squares(graph, estimate);
  for (int step = 0; step < kMostSteps; ++step) {
    if (!elimination_.linearise(graph, estimate) || std::isnan(now)) {
      estimate = given_;
      return false;
    }
    elimination_.minimise(graph, estimate, minimum_);
    const double gain = now - minimum_.squares;
    const double before = std::exchange(now, take_step(graph, now, estimate));
    if (gain < tolerance || (stops_at_rise_ && now == before)) break;
  }
  return true;
}

/// The sum (21.1), infinite if newest poses have no multipliers and may be impossible to reach.
double GaussNewton::squares(const FactorGraph& graph, const GraphEstimate& estimate) const {
  if (estimate.multipliers.size() < graph.poses()) return std::numeric_limits<double>::infinity();
  double sum = graph.prior().squares(estimate.start_multiplier, estimate.landmarks);
  for (std::size_t t = 0; t < graph.poses(); ++t) {
    const Eigen::Vector3d& m = estimate.multipliers[t];
    sum += m.dot(symmetric(graph.motion(t).covariance()) * m);
    for (const auto& [landmark, observed] : graph.observations_of(t)) {
      const auto expected = sensor_.linearised(estimate.poses[t], estimate.landmarks[landmark]);
      if (!expected) continue;
      const Eigen::Vector2d off = sensor_.residual(observed, expected->value);
      sum += off(0) * off(0) / sensor_.variances()(0) + off(1) * off(1) / sensor_.variances()(1);
    }
  }
  return sum;
}

/// Moves the estimate by `share` of the way to the minimum.
void GaussNewton::move(double share, GraphEstimate& estimate) const {
  const Eigen::Vector3d start_way = share * minimum_.start_step;
  Pose& start = estimate.start;
  start = {start.x + start_way(0), start.y + start_way(1), start.heading + start_way(2)};
  estimate.start_multiplier += share * (minimum_.start_multiplier - estimate.start_multiplier);
  for (std::size_t t = 0; t < estimate.displacements.size(); ++t) {
    Pose& d = estimate.displacements[t];
    const Eigen::Vector3d way = share * boxminus(minimum_.displacements[t], d);
    d = {d.x + way(0), d.y + way(1), wrap(d.heading + way(2))};
    Eigen::Vector3d& m = estimate.multipliers[t];
    m += share * (minimum_.multipliers[t] - m);
  }
  for (std::size_t l = 0; l < estimate.in_frame.size(); ++l) {
    Point& p = estimate.in_frame[l];
    const Point way = minimum_.in_frame[l] - p;
    p = p + Point{share * way.x, share * way.y};
  }
}

/// Returns the sum of squares after the step. The first step of a new pose is taken in full, since
/// only then is its displacement possible for its motion. With derivatives at first estimates there
/// may be no share of the step that lowers the sum: the estimate is then left as it is.
double GaussNewton::take_step(const FactorGraph& graph, double before, GraphEstimate& estimate) {
  estimate.multipliers.resize(graph.poses(), Eigen::Vector3d::Zero());
  double share = 1.0;
  for (int halvings = 0;; ++halvings, share *= 0.5) {
    tried_ = estimate;
    move(share, tried_);
    tried_.compose(graph);
    const double after = squares(graph, tried_);
    const bool rises = after > before * (1.0 + kCostRounding);
    if (rises && halvings < kMostStepHalvings) continue;
    if (rises && stops_at_rise_) return before;
    estimate = tried_;
    return after;
  }
}

}  // namespace montecarta::filters
