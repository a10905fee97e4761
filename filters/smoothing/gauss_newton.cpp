// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/gauss_newton.hpp"

#include <cmath>
#include <limits>

namespace montecarta::filters {
namespace {

constexpr int kMostSteps = 20;
constexpr int kMostHalvings = 10;
/// Rises of the sum by less than this share are rounding.
constexpr double kRounding = 1e-12;

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
    now = take_step(graph, now, estimate);
    if (gain < tolerance) break;
  }
  return true;
}

/// Infinite where the newest poses lie as no motion can have led to them.
double GaussNewton::squares(const FactorGraph& graph, const GraphEstimate& estimate) const {
  if (estimate.multipliers.size() < graph.poses()) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (std::size_t t = 0; t < graph.poses(); ++t) {
    const Eigen::Vector3d& m = estimate.multipliers[t];
    sum += m.dot(symmetric(graph.motion(t).covariance()) * m);
    for (const auto& [landmark, observed] : graph.observations_of(t)) {
      const auto expected = predicted_observation(estimate.poses[t], estimate.landmarks[landmark]);
      if (too_near(expected)) continue;
      const auto [range, bearing] = residual(observed, expected);
      sum += range * range / noise_.range + bearing * bearing / noise_.bearing;
    }
  }
  return sum;
}

/// By that share of the way to the minimum.
void GaussNewton::move(double share, GraphEstimate& estimate) const {
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

/// Returns the sum of squares behind it. The first step of a new pose is taken in full: it makes
/// its displacement one that its motion can have.
double GaussNewton::take_step(const FactorGraph& graph, double before, GraphEstimate& estimate) {
  estimate.multipliers.resize(graph.poses(), Eigen::Vector3d::Zero());
  double share = 1.0;
  for (int halvings = 0;; ++halvings, share *= 0.5) {
    tried_ = estimate;
    move(share, tried_);
    tried_.compose(graph);
    const double after = squares(graph, tried_);
    if (after > before * (1.0 + kRounding) && halvings < kMostHalvings) continue;
    estimate = tried_;
    return after;
  }
}

}  // namespace montecarta::filters
