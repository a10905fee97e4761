// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/control_motion.hpp"
#include "filters/smoothing/factor_graph.hpp"
#include "tests/filters/small_world.hpp"

#include <algorithm>
#include <vector>

namespace montecarta::filters {

/// The factor graph of a small world, association known, and an estimate to begin with.
struct SmallGraph {
  FactorGraph graph;
  GraphEstimate estimate;
  std::vector<std::int32_t> identities;  ///< {landmark}
};

/// The start of an estimate of the graph.
enum class Beginning { dead_reckoning, truth };

inline SmallGraph small_graph(const SmallWorld& world, const Belief& belief, Beginning beginning) {
  SmallGraph small;
  small.graph.start(world.itinerary.start);
  MotionIncrement motion;
  Pose at = world.itinerary.start;
  for (std::size_t step = 0, scan = 0; step < world.itinerary.steps(); ++step) {
    advance(motion, world.drive.controls[step], world.itinerary.duration(step), belief,
            Motion::quadrature);
    if (world.itinerary.scan_step[scan] != step) continue;
    small.graph.add_pose(motion);
    at = beginning == Beginning::truth ? world.drive.truth[step] : composed(at, motion.pose());
    small.estimate.add_pose(small.graph, at);
    for (const Detection& detection : world.drive.scan(scan)) {
      const auto found = std::ranges::find(small.identities, detection.identity);
      const auto landmark = static_cast<std::uint32_t>(found - small.identities.begin());
      small.graph.add_observation(landmark, vector_of(detection));
      if (found != small.identities.end()) continue;
      small.identities.push_back(detection.identity);
      const Eigen::Vector2d place = placed_landmark(belief.sensor, at, vector_of(detection))->point;
      small.estimate.add_landmark({place.x(), place.y()});
    }
    motion.restart();
    ++scan;
  }
  return small;
}

}  // namespace montecarta::filters
