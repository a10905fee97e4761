// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/elimination.hpp"

#include "filters/joint/joint_gaussian.hpp"
#include "filters/joint/products.hpp"
#include "filters/joint/retraction.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace montecarta::filters {
namespace {

/// Row of the first landmark: row 0 is that of the constant, row 1 is empty.
constexpr Eigen::Index kConstantRows = 2;
/// Poses of a segment.
constexpr std::size_t kSegment = 24;
/// Columns that a pose between two segments adds to the information's factors, and how many are
/// multiplied at once.
constexpr Eigen::Index kColumns = 9;
constexpr Eigen::Index kPanel = 14 * kColumns;

Eigen::Index row_in_form(std::size_t landmark) { return kConstantRows + row_of(landmark); }

/// Constant and landmarks of a segment's rows, added to those of all landmarks.
void add_rows(const Segment& segment, const Segment::Rows& own, Segment::Rows& all) {
  all.row(0) += own.row(0);
  for (std::size_t k = 0; k < segment.landmarks().size(); ++k) {
    all.middleRows<2>(row_in_form(segment.landmarks()[k])) +=
        own.middleRows<2>(Segment::kLandmarkRow + row_of(k));
  }
}

}  // namespace

std::span<Elimination::Link> Elimination::links() { return std::span(links_).first(n_links_); }

void Elimination::begin(const FactorGraph& graph) {
  n_links_ = (graph.poses() + kSegment - 1) / kSegment;
  if (links_.size() < n_links_) links_.resize(n_links_);
  height_ = packed(graph.landmarks() + 1);
  if (information_.rows() < height_) {
    information_.resize(2 * height_, 2 * height_);
    left_.resize(2 * height_, kPanel);
    right_.resize(2 * height_, kPanel);
  }
  information_.topLeftCorner(height_, height_).setZero();
  given_.setZero(height_, 3);
  rows_ = 0;
  covariance_.setZero();
  filled_ = 0;
}

bool Elimination::linearise(const FactorGraph& graph, const GraphEstimate& estimate) {
  begin(graph);
  std::size_t first = 0;
  for (Link& link : links()) {
    const std::size_t end = std::min(first + kSegment, graph.poses());
    link.segment.linearise(graph, estimate, first, end, noise_, scratch_);
    join(link);
    first = end;
  }
  flush();
  const Eigen::Index n = row_of(graph.landmarks());
  if (n == 0) return true;
  return factor_.factorise(information_.block(kConstantRows, kConstantRows, n, n));
}

/// The pose before a segment, in the form of all landmarks, is conditioned on what the segment says
/// of it and eliminated; the last pose of the segment has that form then.
void Elimination::join(Link& link) {
  const Segment& segment = link.segment;
  const Eigen::Matrix3d on_itself = segment.on_pose().middleRows<3>(Segment::kPoseRow);
  gradient_ = given_.lazyProduct(on_itself);
  add_rows(segment, segment.on_pose(), gradient_);
  const Eigen::Matrix3d spread = Eigen::Matrix3d::Identity() + covariance_ * on_itself;
  link.covariance = spread.partialPivLu().solve(covariance_);
  mirror_lower(link.covariance);
  add_information(link);

  const Eigen::Matrix3d way = segment.given().middleRows<3>(Segment::kPoseRow);
  given_ = ((given_ - gradient_.lazyProduct(link.covariance)) * way).eval();
  add_rows(segment, segment.given(), given_);
  covariance_ = way.transpose() * link.covariance * way + segment.covariance();
  mirror_lower(covariance_);
}

/// The sum of squares of all segments so far, the pose before the last eliminated: with its form A,
/// its gradient H, K = H - A I / 2 and C, A K' + K A' - H C H' more, besides what the segment says
/// of the landmarks alone.
void Elimination::add_information(const Link& link) {
  if (filled_ == kPanel) flush();
  const Eigen::Matrix3d on_itself = link.segment.on_pose().middleRows<3>(Segment::kPoseRow);
  auto left = left_.block(0, filled_, height_, kColumns);
  auto right = right_.block(0, filled_, height_, kColumns);
  filled_ += kColumns;
  left.leftCols<3>() = given_;
  right.leftCols<3>() = gradient_ - given_.lazyProduct(0.5 * on_itself);
  left.middleCols<3>(3) = right.leftCols<3>();
  right.middleCols<3>(3) = given_;
  left.rightCols<3>() = -gradient_.lazyProduct(link.covariance);
  right.rightCols<3>() = gradient_;

  const auto landmarks = link.segment.landmarks();
  rows_ = std::max(rows_, packed(1));
  for (const std::uint32_t l : landmarks) rows_ = std::max(rows_, packed(l + 2));
  const Eigen::MatrixXd& own = scratch_.information;
  information_(0, 0) += own(0, 0);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Eigen::Index from = Segment::kLandmarkRow + row_of(i), row = row_in_form(landmarks[i]);
    information_.block<2, 1>(row, 0) += own.block<2, 1>(from, 0);
    for (std::size_t j = 0; j <= i; ++j) {
      const Eigen::Matrix2d block = own.block<2, 2>(from, Segment::kLandmarkRow + row_of(j));
      const Eigen::Index column = row_in_form(landmarks[j]);
      if (row >= column) {
        information_.block<2, 2>(row, column) += block;
      } else {
        information_.block<2, 2>(column, row) += block.transpose();
      }
    }
  }
}

void Elimination::flush() {
  add_product(left_.topLeftCorner(rows_, filled_), right_.topLeftCorner(rows_, filled_),
              Part::lower, information_.topLeftCorner(rows_, rows_));
  filled_ = 0;
}

void Elimination::minimise(const FactorGraph& graph, const GraphEstimate& estimate,
                           GraphMinimum& minimum) {
  const Eigen::Index n = row_of(graph.landmarks());
  step_ = -information_.col(0).segment(kConstantRows, n);
  if (n > 0) factor_.solve_in_place(step_);
  filter_links();
  smooth_links();
  minimum.multipliers.resize(graph.poses());
  minimum.displacements.resize(graph.poses());
  minimum.squares = 0.0;
  for (Link& link : links()) {
    minimum.squares +=
        link.segment.minimise(graph, estimate, step_, link.smoothed, link.adjoint, minimum);
  }
  place_landmarks(graph, estimate, minimum);
}

/// Constant and landmarks' part of {row, 3}, the landmarks where the sum is least.
Eigen::Vector3d Elimination::at_minimum(const Segment& segment, const Segment::Rows& rows) const {
  Eigen::Vector3d sum = rows.row(0);
  for (std::size_t k = 0; k < segment.landmarks().size(); ++k) {
    sum += rows.middleRows<2>(Segment::kLandmarkRow + row_of(k)).transpose() *
           step_.segment<2>(row_of(segment.landmarks()[k]));
  }
  return sum;
}

/// Half the gradient of a segment's sum of squares by the pose before it.
Eigen::Vector3d Elimination::gradient(const Segment& segment, const Eigen::Vector3d& x) const {
  return at_minimum(segment, segment.on_pose()) +
         segment.on_pose().middleRows<3>(Segment::kPoseRow) * x;
}

void Elimination::filter_links() {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  for (Link& link : links()) {
    const Segment& segment = link.segment;
    link.filtered = x - link.covariance * gradient(segment, x);
    x = at_minimum(segment, segment.given()) +
        segment.given().middleRows<3>(Segment::kPoseRow).transpose() * link.filtered;
  }
}

void Elimination::smooth_links() {
  Eigen::Vector3d adjoint = Eigen::Vector3d::Zero();
  for (std::size_t i = n_links_; i-- > 0;) {
    Link& link = links_[i];
    link.adjoint = adjoint;
    adjoint = link.segment.given().middleRows<3>(Segment::kPoseRow) * adjoint;
    link.smoothed = link.filtered + link.covariance * adjoint;
    adjoint -= gradient(link.segment, link.smoothed);
  }
}

/// The landmarks' steps in the frames of their first poses, which step as well.
void Elimination::place_landmarks(const FactorGraph& graph, const GraphEstimate& estimate,
                                  GraphMinimum& minimum) {
  minimum.in_frame.resize(graph.landmarks());
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  std::size_t l = 0;
  for (std::size_t t = 0; t < graph.poses(); ++t) {
    const Pose& mean = graph.motion(t).pose();
    const Pose& now = minimum.displacements[t];
    const Point noise = in_world(estimate.directions[t], now.x - mean.x, now.y - mean.y);
    links_[t / kSegment].segment.advance(t, {noise.x, noise.y, wrap(now.heading - mean.heading)},
                                         x);
    const Pose& pose = estimate.poses[t];
    for (; l < graph.landmarks() && graph.first_pose_of(l) == t; ++l) {
      const Eigen::Vector2d away = to_vector(estimate.landmarks[l]) - place_of(pose);
      const Eigen::Vector2d step =
          step_.segment<2>(row_of(l)) - x.head<2>() - quarter_turn() * away * x(2);
      const Pose moved = relative_to({0.0, 0.0, pose.heading}, {step.x(), step.y(), 0.0});
      minimum.in_frame[l] = estimate.in_frame[l] + Point{moved.x, moved.y};
    }
  }
}

void Elimination::covariance(Eigen::Matrix3d& pose, MapMoments& map) const {
  const Eigen::Index n = factor_.rows();
  map.make_room(packed(static_cast<std::size_t>(n / 2)));
  map.clear(map.room());
  const auto G = given_.middleRows(kConstantRows, n);
  auto P = map.covariance.topLeftCorner(n, n);
  factor_.inverse(P);
  map.cross.topRows(n).noalias() = P * G;
  pose = covariance_ + G.transpose() * map.cross.topRows(n);
  mirror_lower(pose);
}

}  // namespace montecarta::filters
