// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/elimination.hpp"

#include "filters/joint/joint_gaussian.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace montecarta::filters {
namespace {

/// Returns L^-1 A.
template <int N>
Eigen::Matrix<double, 2, N> whitened(const InnovationFactor& L, Eigen::Matrix<double, 2, N> A) {
  for (Eigen::Index j = 0; j < N; ++j) A.col(j) = L.whiten(A.col(j));
  return A;
}

/// Row of the first landmark: row 0 is that of the constant, and row 1 is empty.
constexpr Eigen::Index kConstantRows = 2;
/// Number of poses of a segment.
constexpr std::size_t kSegment = 24;
/// Number of columns that a pose between two segments adds to the factors of the information, and
/// number of columns that are multiplied together.
constexpr Eigen::Index kColumns = 9;
constexpr Eigen::Index kPanel = 14 * kColumns;

Eigen::Index row_in_form(std::size_t landmark) { return kConstantRows + row_of(landmark); }

/// Adds the rows of the constant and of the landmarks of a segment to those of all landmarks.
void add_rows(const Segment& segment, const Segment::Rows& own, Segment::Rows& all) {
  all.row(0) += own.row(0);
  for (std::size_t k = 0; k < segment.landmarks().size(); ++k) {
    all.middleRows<2>(row_in_form(segment.landmarks()[k])) +=
        own.middleRows<2>(Segment::kLandmarkRow + row_of(k));
  }
}

}  // namespace

LinearMotion LinearMotion::of(const FactorGraph& graph, const GraphEstimate& estimate,
                              const LinearisationPlaces& places, std::size_t t) {
  const MotionIncrement& motion = graph.motion(t);
  const Direction<double>& heading = estimate.directions[t];
  const Pose& before = t == 0 ? estimate.start : estimate.poses[t - 1];
  const Pose& after = estimate.poses[t];
  const Eigen::Vector2d expected = to_vector(in_world(heading, motion.pose().x, motion.pose().y)) -
                                   (place_of(after) - place_of(before));
  const double turned_by = wrap(after.heading - before.heading);
  return {.way = quarter_turn() * (place_of(places.pose(t)) - place_of(places.before(t))),
          .offset = {expected.x(), expected.y(), wrap(motion.pose().heading - turned_by)},
          .noise = symmetric(turned(motion.covariance(), heading))};
}

void LinearMotion::carry(Rows& given, Eigen::Matrix3d& covariance) const {
  for (Eigen::Index i = 0; i < 2; ++i) given.col(i) += way(i) * given.col(2);
  given.row(0) += offset.transpose();
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
  A.topRightCorner<2, 1>() = way;
  covariance = A * covariance * A.transpose() + noise;
  mirror_lower(covariance);
}

void Segment::linearise(const FactorGraph& graph, const GraphEstimate& estimate,
                        const LinearisationPlaces& places, std::size_t begin, std::size_t end,
                        const BelievedSensor& sensor, SegmentScratch& scratch) {
  begin_ = begin;
  end_ = end;
  start(graph, scratch);
  for (std::size_t t = begin; t < end; ++t) {
    motions_.push_back(LinearMotion::of(graph, estimate, places, t));
    motions_.back().carry(given_, covariance_);
    for (const FactorGraph::Observation& observation : graph.observations_of(t)) {
      const std::uint32_t l = observation.landmark;
      auto at = sensor.linearised(places.pose(t), places.landmark(l));
      if (at && places.differ()) {
        const auto now = sensor.linearised(estimate.poses[t], estimate.landmarks[l]);
        if (now) at->value = now->value;
        if (!now) at.reset();
      }
      condition(observation, at, sensor, scratch);
    }
  }
  const auto used = scratch.panel.topLeftCorner(
      given_.rows(), 2 * static_cast<Eigen::Index>(observations_.size()));
  add_product(used, used, Part::lower, scratch.information);
  on_pose_ = scratch.information.middleCols<3>(kPoseRow);
  on_pose_.row(0) = scratch.information.col(0).segment<3>(kPoseRow).transpose();
  for (const std::uint32_t landmark : landmarks_) scratch.row_of_landmark[landmark] = 0;
}

void Segment::start(const FactorGraph& graph, SegmentScratch& scratch) {
  motions_.clear();
  observations_.clear();
  landmarks_.clear();
  scratch.row_of_landmark.resize(graph.landmarks(), 0);
  for (std::size_t k = graph.begin_of(begin_); k < graph.begin_of(end_); ++k) {
    const std::uint32_t landmark = graph.observation(k).landmark;
    Eigen::Index& row = scratch.row_of_landmark[landmark];
    if (row > 0) continue;
    row = kLandmarkRow + row_of(landmarks_.size());
    landmarks_.push_back(landmark);
  }
  const Eigen::Index height = kLandmarkRow + packed(landmarks_.size());
  const auto rows = static_cast<Eigen::Index>(2 * (graph.begin_of(end_) - graph.begin_of(begin_)));
  scratch.information.setZero(height, height);
  if (scratch.panel.rows() < height || scratch.panel.cols() < rows) {
    scratch.panel.resize(2 * height, 2 * rows);
  }
  given_.setZero(height, 3);
  given_.middleRows<3>(kPoseRow).setIdentity();
  covariance_.setZero();
}

/// An observation of a landmark too near for a derivative is left out of this linearisation.
void Segment::condition(const FactorGraph::Observation& observation,
                        const std::optional<LinearisedDetection>& at, const BelievedSensor& sensor,
                        SegmentScratch& scratch) {
  LinearObservation seen{Matrix23::Zero(), Eigen::Matrix2d::Zero(), Eigen::Vector2d::Zero(),
                         Matrix32::Zero(), Eigen::Vector2d::Zero()};
  if (at) {
    const Matrix23& H = at->by_pose;
    Eigen::Matrix2d S = H * covariance_ * H.transpose();
    S.diagonal() += sensor.variances();
    if (const auto L = factor(S)) {
      seen.pose = whitened(*L, H);
      seen.landmark = whitened(*L, at->by_landmark);
      seen.residual = L->whiten(sensor.residual(observation.observed, at->value));
      seen.gain = covariance_ * seen.pose.transpose();
    }
  }
  add_rows(seen, scratch.row_of_landmark[observation.landmark], scratch);
}

/// Adds two rows to the sum of squares, and conditions the pose on them (EQUATIONS (21.4)).
void Segment::add_rows(const LinearObservation& seen, Eigen::Index row, SegmentScratch& scratch) {
  const auto first = 2 * static_cast<Eigen::Index>(observations_.size());
  auto used = scratch.panel.block(0, first, given_.rows(), 2);
  used.noalias() = given_.lazyProduct(seen.pose.transpose());
  used.row(0) -= seen.residual.transpose();
  used.middleRows<2>(row) += seen.landmark.transpose();
  for (Eigen::Index j = 0; j < 3; ++j) {
    given_.col(j) -= used.col(0) * seen.gain(j, 0) + used.col(1) * seen.gain(j, 1);
  }
  covariance_ -= seen.gain * seen.gain.transpose();
  mirror_lower(covariance_);
  observations_.push_back(seen);
}

double Segment::minimise(const FactorGraph& graph, const GraphEstimate& estimate,
                         const Eigen::VectorXd& landmark_steps, const Eigen::Vector3d& before,
                         const Eigen::Vector3d& adjoint, GraphMinimum& minimum) {
  const double squares = filter_poses(graph, landmark_steps, before);
  smooth_poses(graph, estimate, adjoint, minimum);
  return squares + adjoint.dot(covariance_ * adjoint);
}

/// Computes the innovations of a Kalman filter of the poses, given the landmarks.
double Segment::filter_poses(const FactorGraph& graph, const Eigen::VectorXd& landmark_steps,
                             Eigen::Vector3d x) {
  double squares = 0.0;
  const std::size_t first = graph.begin_of(begin_);
  for (std::size_t t = begin_; t < end_; ++t) {
    advance(t, Eigen::Vector3d::Zero(), x);
    for (std::size_t k = graph.begin_of(t); k < graph.begin_of(t + 1); ++k) {
      LinearObservation& seen = observations_[k - first];
      const auto landmark = landmark_steps.segment<2>(row_of(graph.observation(k).landmark));
      seen.innovation = seen.residual - seen.pose * x - seen.landmark * landmark;
      x += seen.gain * seen.innovation;
      squares += seen.innovation.squaredNorm();
    }
  }
  return squares;
}

void Segment::advance(std::size_t pose, const Eigen::Vector3d& noise, Eigen::Vector3d& x) const {
  const LinearMotion& motion = motions_[pose - begin_];
  x.head<2>() += motion.way * x(2);
  x += motion.offset + noise;
}

/// Smooths backwards by Bryson and Frazier (EQUATIONS (21.7)), without the inverse of a covariance.
void Segment::smooth_poses(const FactorGraph& graph, const GraphEstimate& estimate,
                           Eigen::Vector3d adjoint, GraphMinimum& minimum) const {
  const std::size_t first = graph.begin_of(begin_);
  for (std::size_t t = end_; t-- > begin_;) {
    for (std::size_t k = graph.begin_of(t + 1); k-- > graph.begin_of(t);) {
      const LinearObservation& seen = observations_[k - first];
      adjoint += seen.pose.transpose() * (seen.innovation - seen.gain.transpose() * adjoint);
    }
    const Direction<double>& heading = estimate.directions[t];
    Eigen::Vector3d& multiplier = minimum.multipliers[t];
    multiplier << heading.cosine * adjoint(0) + heading.sine * adjoint(1),
        heading.cosine * adjoint(1) - heading.sine * adjoint(0), adjoint(2);
    const Eigen::Vector3d way = symmetric(graph.motion(t).covariance()) * multiplier;
    const Pose& mean = graph.motion(t).pose();
    minimum.displacements[t] = {mean.x + way(0), mean.y + way(1), wrap(mean.heading + way(2))};
    adjoint(2) += motions_[t - begin_].way.dot(adjoint.head<2>());
  }
}

std::span<Elimination::Link> Elimination::links() { return std::span(links_).first(n_links_); }

void Elimination::begin(const FactorGraph& graph, const GraphEstimate& estimate) {
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
  if (graph.has_prior()) begin_at(graph.prior(), estimate);
  start_ = given_;
}

/// Begins with the prior, in terms of ways from the estimate instead of its own.
void Elimination::begin_at(const GraphPrior& prior, const GraphEstimate& estimate) {
  const Eigen::Index n = prior.given.rows();
  const Eigen::VectorXd way = prior.way_to(estimate.landmarks);
  given_.topRows(n) = prior.given;
  given_.row(0) +=
      way.transpose() * prior.given - boxminus(estimate.start, prior.start).transpose();
  covariance_ = prior.covariance;
  auto information = information_.topLeftCorner(n, n);
  information.triangularView<Eigen::Lower>() = prior.information;
  const Eigen::VectorXd gradient = prior.information.selfadjointView<Eigen::Lower>() * way;
  information.col(0) += gradient;
  information(0, 0) += gradient(0) + way.dot(gradient);
  rows_ = packed(prior.landmarks.size() + 1);
}

void Elimination::marginalise_first_pose(const FactorGraph& graph, const GraphEstimate& estimate,
                                         GraphPrior& prior) {
  begin(graph, estimate);
  const LinearisationPlaces places(jacobians_, graph, estimate);
  links_[0].segment.linearise(graph, estimate, places, 0, 1, sensor_, scratch_);
  join(links_[0]);
  flush();
  LinearMotion::of(graph, estimate, places, 1).carry(given_, covariance_);
  std::size_t n_landmarks = graph.prior().landmarks.size();
  while (n_landmarks < graph.landmarks() && graph.first_pose_of(n_landmarks) == 0) ++n_landmarks;
  prior.first = graph.prior().first;
  const auto seen = std::span(estimate.landmarks).first(n_landmarks);
  prior.landmarks.assign(seen.begin(), seen.end());
  for (const Point& added : seen.subspan(prior.first.size())) prior.first.push_back(added);
  const Eigen::Index n = row_in_form(n_landmarks);
  prior.start = estimate.poses[1];
  prior.given = given_.topRows(n);
  prior.covariance = covariance_;
  prior.information = information_.topLeftCorner(n, n);
}

bool Elimination::linearise(const FactorGraph& graph, const GraphEstimate& estimate) {
  begin(graph, estimate);
  const LinearisationPlaces places(jacobians_, graph, estimate);
  std::size_t first = 0;
  for (Link& link : links()) {
    const std::size_t end = std::min(first + kSegment, graph.poses());
    link.segment.linearise(graph, estimate, places, first, end, sensor_, scratch_);
    join(link);
    first = end;
  }
  flush();
  const Eigen::Index n = row_of(graph.landmarks());
  if (n == 0) return true;
  return factor_.factorise(information_.block(kConstantRows, kConstantRows, n, n));
}

/// Conditions the pose before a segment, in terms of all landmarks, on the information of the
/// segment, and eliminates it. Afterwards the last pose of the segment is known in these terms.
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

/// Adds a segment, without the pose before it, to the sum of squares. With A the form of that pose
/// (given_), H the gradient, I the information of the segment about the pose and K = H - A I / 2,
/// this adds A K' + K A' - H C H' and the information of the segment about the landmarks alone.
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
  minimum.start_multiplier = smooth_links();
  minimum.start_step = links_[0].smoothed;
  minimum.multipliers.resize(graph.poses());
  minimum.displacements.resize(graph.poses());
  minimum.in_map.clear();
  for (std::size_t l = 0; l < graph.prior().landmarks.size(); ++l) {
    minimum.in_map.push_back(estimate.landmarks[l] + Point{step_(row_of(l)), step_(row_of(l) + 1)});
  }
  minimum.squares = graph.prior().squares(minimum.start_multiplier, minimum.in_map);
  for (Link& link : links()) {
    minimum.squares +=
        link.segment.minimise(graph, estimate, step_, link.smoothed, link.adjoint, minimum);
  }
  place_landmarks(graph, estimate, minimum);
}

/// Value of the form {row, 3} at the minimum: its constant plus the share of the landmarks.
Eigen::Vector3d Elimination::at_minimum(const Segment& segment, const Segment::Rows& rows) const {
  Eigen::Vector3d sum = rows.row(0);
  for (std::size_t k = 0; k < segment.landmarks().size(); ++k) {
    sum += rows.middleRows<2>(Segment::kLandmarkRow + row_of(k)).transpose() *
           step_.segment<2>(row_of(segment.landmarks()[k]));
  }
  return sum;
}

/// Half the gradient of the sum of squares of a segment by the pose before it.
Eigen::Vector3d Elimination::gradient(const Segment& segment, const Eigen::Vector3d& x) const {
  return at_minimum(segment, segment.on_pose()) +
         segment.on_pose().middleRows<3>(Segment::kPoseRow) * x;
}

void Elimination::filter_links() {
  Eigen::Vector3d x = start_.row(0).transpose() +
                      start_.middleRows(kConstantRows, step_.size()).transpose() * step_;
  for (Link& link : links()) {
    const Segment& segment = link.segment;
    link.filtered = x - link.covariance * gradient(segment, x);
    x = at_minimum(segment, segment.given()) +
        segment.given().middleRows<3>(Segment::kPoseRow).transpose() * link.filtered;
  }
}

/// Returns the multiplier of the start.
Eigen::Vector3d Elimination::smooth_links() {
  Eigen::Vector3d adjoint = Eigen::Vector3d::Zero();
  for (std::size_t i = n_links_; i-- > 0;) {
    Link& link = links_[i];
    link.adjoint = adjoint;
    adjoint = link.segment.given().middleRows<3>(Segment::kPoseRow) * adjoint;
    link.smoothed = link.filtered + link.covariance * adjoint;
    adjoint -= gradient(link.segment, link.smoothed);
  }
  return adjoint;
}

/// Computes the steps of the landmarks in the frames of their first poses, which move as well.
void Elimination::place_landmarks(const FactorGraph& graph, const GraphEstimate& estimate,
                                  GraphMinimum& minimum) {
  minimum.in_frame.resize(graph.landmarks());
  std::ranges::copy(minimum.in_map, minimum.in_frame.begin());
  Eigen::Vector3d x = minimum.start_step;
  std::size_t l = minimum.in_map.size();
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
