// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/stream.hpp"
#include "filters/relative/relative_chain.hpp"

#include <Eigen/Core>

namespace montecarta::filters {

/// A Gaussian over a relative chain: three displacements with rows in no order, a landmark in each
/// of two frames in polar coordinates, and one in Cartesian ones.
struct SomeChain {
  RelativeChain chain;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(16);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(16, 16);
};

/// Rows of headings and bearings have deviations of about `radians`, the others of 0.3 m; all are
/// correlated.
inline SomeChain some_chain(double radians, std::uint64_t seed = 1) {
  SomeChain some;
  some.chain = {.start = {3.0, -4.0, -1.2},
                .displacements = {5, 8, 0},
                .landmarks = {{{3, 1, true}, {}}, {{11, 0, true}, {}}, {{13, 2, false}, {}}}};
  some.mean.head<15>() << 4.0, 1.0, 0.4, 9.0, -0.6, 6.0, -1.0, 0.9, 7.0, 2.0, -0.5, 5.0, 1.2, 3.0,
      -8.0;
  RngStream draw({.seed = seed, .purpose = Draw::test});
  const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(15, 20, [&] { return draw.normal(); });
  Eigen::VectorXd scale = Eigen::VectorXd::Constant(15, 0.3 / std::sqrt(20.0));
  for (const Eigen::Index row : {2, 4, 7, 10, 12}) scale(row) *= radians / 0.3;
  some.P.topLeftCorner<15, 15>() = scale.asDiagonal() * A * A.transpose() * scale.asDiagonal();
  return some;
}

/// The vehicle's pose and the landmarks in the map, of one point of the chain's space.
inline Eigen::VectorXd in_map(const RelativeChain& chain, const Eigen::VectorXd& x) {
  std::vector<Pose> frames{chain.start};
  for (std::size_t k = 0; k < chain.displacements.size(); ++k)
    frames.push_back(composed(frames.back(), displacement(chain, k, x)));
  Eigen::VectorXd places(3 + 2 * static_cast<Eigen::Index>(chain.landmarks.size()));
  places.head<3>() << frames.back().x, frames.back().y, frames.back().heading;
  Eigen::Index row = 3;
  for (const auto& [first, again] : chain.landmarks) {
    const Point local = linearised_point(first, x).place;
    const Pose place = composed(frames[first.frame], {local.x, local.y, 0.0});
    places.segment<2>(row) << place.x, place.y;
    row += 2;
  }
  return places;
}

}  // namespace montecarta::filters
