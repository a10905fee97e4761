// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/relative_chain.hpp"

namespace montecarta::filters {

LinearisedComposition linearised_composition(const Pose& first, const Pose& second) {
  const Direction<double> d = direction_of(first.heading);
  const auto [x, y] = in_world(d, second.x, second.y);
  LinearisedComposition both;
  both.pose = {first.x + x, first.y + y, wrap(first.heading + second.heading)};
  both.by_first << 1.0, 0.0, -y, 0.0, 1.0, x, 0.0, 0.0, 1.0;
  both.by_second << d.cosine, -d.sine, 0.0, d.sine, d.cosine, 0.0, 0.0, 0.0, 1.0;
  return both;
}

LinearisedPoint linearised_point(const RelativeChain::Point& point, const Eigen::VectorXd& mean) {
  const double first = mean(point.row), second = mean(point.row + 1);
  if (!point.is_polar) return {{first, second}, Eigen::Matrix2d::Identity()};
  const Direction<double> ray = direction_of(second);
  LinearisedPoint polar;
  polar.place = {first * ray.cosine, first * ray.sine};
  polar.by_coordinates << ray.cosine, -polar.place.y, ray.sine, polar.place.x;
  return polar;
}

Pose displacement(const RelativeChain& chain, std::size_t k, const Eigen::VectorXd& mean) {
  const Eigen::Index row = chain.displacements[k];
  return {mean(row), mean(row + 1), mean(row + 2)};
}

}  // namespace montecarta::filters
