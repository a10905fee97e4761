// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/drives/random_map.hpp"

#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"

#include <cmath>

namespace montecarta::experiments {

std::vector<Eigen::Vector2d> RandomMap::operator()(std::uint64_t run) const {
  std::vector<Eigen::Vector2d> landmarks;
  StreamIdentity identity{
      .seed = seed_, .run = run, .step = 0, .index = 0, .purpose = Draw::world_landmark};
  for (const Eigen::Vector2d& place : places_) {
    RngStream draw(identity);
    ++identity.index;
    const double distance = shift_ * std::sqrt(draw.uniform());  // even over the disc
    const double direction = kTwoPi * draw.uniform();
    landmarks.emplace_back(place.x() + distance * std::cos(direction),
                           place.y() + distance * std::sin(direction));
  }
  return landmarks;
}

}  // namespace montecarta::experiments
