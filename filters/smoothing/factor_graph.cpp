// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/factor_graph.hpp"

namespace montecarta::filters {

void FactorGraph::start(const Pose& start) {
  start_ = start;
  motions_.clear();
  begin_.assign(1, 0);
  observations_.clear();
  first_pose_.clear();
}

void FactorGraph::add_pose(const MotionIncrement& motion) {
  motions_.push_back(motion);
  begin_.push_back(observations_.size());
}

void FactorGraph::add_observation(std::uint32_t landmark, const Eigen::Vector2d& observed) {
  if (landmark == first_pose_.size()) first_pose_.push_back(poses() - 1);
  observations_.push_back({landmark, observed});
  begin_.back() = observations_.size();
}

std::span<const FactorGraph::Observation> FactorGraph::observations_of(std::size_t pose) const {
  return std::span(observations_).subspan(begin_[pose], begin_[pose + 1] - begin_[pose]);
}

void GraphEstimate::clear() {
  displacements.clear();
  in_frame.clear();
  multipliers.clear();
  poses.clear();
  directions.clear();
  landmarks.clear();
}

void GraphEstimate::add_pose(const FactorGraph& graph, const Pose& pose) {
  const Pose& before = poses.empty() ? graph.start() : poses.back();
  displacements.push_back(relative_to(before, pose));
  directions.push_back(direction_of(before.heading));
  poses.push_back(pose);
}

void GraphEstimate::add_landmark(const Point& landmark) {
  const Pose place = relative_to(poses.back(), {landmark.x, landmark.y, 0.0});
  in_frame.push_back({place.x, place.y});
  landmarks.push_back(landmark);
}

void GraphEstimate::compose(const FactorGraph& graph) {
  Pose at = graph.start();
  for (std::size_t t = 0; t < displacements.size(); ++t) {
    directions[t] = direction_of(at.heading);
    const Pose& d = displacements[t];
    const Point way = in_world(directions[t], d.x, d.y);
    at = poses[t] = {at.x + way.x, at.y + way.y, wrap(at.heading + d.heading)};
  }
  for (std::size_t l = 0; l < in_frame.size(); ++l) {
    const Pose& from = poses[graph.first_pose_of(l)];
    const Point way = in_world(direction_of(from.heading), in_frame[l].x, in_frame[l].y);
    landmarks[l] = {from.x + way.x, from.y + way.y};
  }
}

}  // namespace montecarta::filters
