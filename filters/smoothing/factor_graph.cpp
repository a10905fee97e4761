// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/factor_graph.hpp"

#include <algorithm>

namespace montecarta::filters {

namespace {

/// Row of the first landmark in the forms of an Elimination.
constexpr Eigen::Index kLandmarkRow = 2;

}  // namespace

void GraphPrior::clear(const Pose& known) {
  start = known;
  landmarks.clear();
  first.clear();
  given.resize(0, 3);
  covariance.setZero();
  information.resize(0, 0);
}

Eigen::VectorXd GraphPrior::way_to(std::span<const Point> now) const {
  Eigen::VectorXd way = Eigen::VectorXd::Zero(given.rows());
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    const Point moved = now[l] - landmarks[l];
    way.segment<2>(kLandmarkRow + 2 * static_cast<Eigen::Index>(l)) << moved.x, moved.y;
  }
  return way;
}

double GraphPrior::squares(const Eigen::Vector3d& multiplier, std::span<const Point> now) const {
  if (given.rows() == 0) return 0.0;
  Eigen::VectorXd way = way_to(now);
  way(0) = 1.0;
  const Eigen::VectorXd gradient = information.selfadjointView<Eigen::Lower>() * way;
  return multiplier.dot(covariance * multiplier) + way.dot(gradient);
}

void FactorGraph::start(const Pose& start) {
  prior_.clear(start);
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

void FactorGraph::replace_first_pose(const GraphPrior& prior) {
  prior_ = prior;
  const std::size_t dropped = begin_[1];
  observations_.erase(observations_.begin(),
                      observations_.begin() + static_cast<std::ptrdiff_t>(dropped));
  motions_.erase(motions_.begin());
  motions_.front() = MotionIncrement();
  begin_.erase(begin_.begin());
  for (std::size_t& begin : begin_) begin -= dropped;
  for (std::size_t& pose : first_pose_) pose -= pose > 0 ? 1 : 0;
}

std::span<const FactorGraph::Observation> FactorGraph::observations_of(std::size_t pose) const {
  return std::span(observations_).subspan(begin_[pose], begin_[pose + 1] - begin_[pose]);
}

void GraphEstimate::clear() {
  start_multiplier.setZero();
  displacements.clear();
  in_frame.clear();
  multipliers.clear();
  poses.clear();
  directions.clear();
  landmarks.clear();
}

void GraphEstimate::add_pose(const FactorGraph& graph, const Pose& pose) {
  if (poses.empty()) start = graph.start();
  const Pose& before = poses.empty() ? start : poses.back();
  displacements.push_back(relative_to(before, pose));
  directions.push_back(direction_of(before.heading));
  poses.push_back(pose);
}

void GraphEstimate::add_landmark(const Point& landmark) {
  const Pose place = relative_to(poses.back(), {landmark.x, landmark.y, 0.0});
  in_frame.push_back({place.x, place.y});
  landmarks.push_back(landmark);
}

void GraphEstimate::move_newest(const Pose& pose) {
  const std::size_t newest = poses.size() - 1;
  displacements[newest] = relative_to(newest == 0 ? start : poses[newest - 1], pose);
  poses[newest] = pose;
}

void GraphEstimate::replace_first_pose(const FactorGraph& graph) {
  start = graph.start();
  const Eigen::Vector3d multiplier = multipliers[1];
  const Point in_map = in_world(directions[1], multiplier(0), multiplier(1));
  start_multiplier << in_map.x, in_map.y, multiplier(2);
  displacements.erase(displacements.begin());
  displacements.front() = {};
  multipliers.erase(multipliers.begin());
  poses.erase(poses.begin());
  directions.erase(directions.begin());
  directions.front() = direction_of(start.heading);
  std::ranges::copy(std::span(landmarks).first(graph.prior().landmarks.size()), in_frame.begin());
}

void GraphEstimate::compose(const FactorGraph& graph) {
  Pose at = start;
  for (std::size_t t = 0; t < displacements.size(); ++t) {
    directions[t] = direction_of(at.heading);
    const Pose& d = displacements[t];
    const Point way = in_world(directions[t], d.x, d.y);
    at = poses[t] = {at.x + way.x, at.y + way.y, wrap(at.heading + d.heading)};
  }
  const std::size_t in_map = graph.prior().landmarks.size();
  std::ranges::copy(std::span(in_frame).first(in_map), landmarks.begin());
  for (std::size_t l = in_map; l < in_frame.size(); ++l) {
    const Pose& from = poses[graph.first_pose_of(l)];
    const Point way = in_world(direction_of(from.heading), in_frame[l].x, in_frame[l].y);
    landmarks[l] = {from.x + way.x, from.y + way.y};
  }
}

}  // namespace montecarta::filters
