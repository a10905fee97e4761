// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/drives/drives_in_known_map.hpp"

#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"

#include <utility>

namespace montecarta::experiments {

DrivesInKnownMap::DrivesInKnownMap(
    std::shared_ptr<const DriveSource> drives,
    std::function<std::vector<Eigen::Vector2d>(std::uint64_t run)> own_landmarks,
    const PriorDeviations& drawn, const PriorDeviations& believed, std::uint64_t seed)
    : drives_(std::move(drives)),
      own_landmarks_(std::move(own_landmarks)),
      drawn_(drawn),
      believed_(believed),
      seed_(seed) {}

void DrivesInKnownMap::generate(std::uint64_t run, Drive& drive) const {
  drives_->generate(run, drive);
  drive.prior = {start_of(run), map_of(run)};
}

PoseMoments DrivesInKnownMap::start_of(std::uint64_t run) const {
  RngStream draw({.seed = seed_, .run = run, .purpose = Draw::world_start});
  const double x = draw.normal(), y = draw.normal(), heading = draw.normal();
  const Pose& truth = itinerary_of(run).start;
  return {{truth.x - drawn_.position * x, truth.y - drawn_.position * y,
           wrap(truth.heading - drawn_.heading * heading)},
          believed_.start_covariance()};
}

std::vector<LandmarkEstimate> DrivesInKnownMap::map_of(std::uint64_t run) const {
  const std::vector<Eigen::Vector2d> truth =
      own_landmarks_ ? own_landmarks_(run) : itinerary_of(run).landmarks;
  std::vector<LandmarkEstimate> map;
  StreamIdentity identity{.seed = seed_, .run = run, .purpose = Draw::world_survey};
  for (const Eigen::Vector2d& place : truth) {
    RngStream draw(identity);
    ++identity.index;
    const double x = draw.normal(), y = draw.normal();
    map.push_back(
        {place - drawn_.landmark * Eigen::Vector2d(x, y), believed_.landmark_covariance()});
  }
  return map;
}

}  // namespace montecarta::experiments
