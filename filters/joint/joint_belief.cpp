// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_belief.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::filters {
namespace {

/// Number of landmarks for which memory is reserved at first; identities may be sparse.
constexpr std::size_t kRoomAtFirst = 300;

bool stands_still(const MotionIncrement& motion) {
  const Pose& pose = motion.pose();
  return pose.x == 0.0 && pose.y == 0.0 && pose.heading == 0.0 &&
         symmetric(motion.covariance()).isZero(0.0);
}

}  // namespace

void LinearisationPoints::start(const Pose& start) {
  pose_ = start;
  landmarks_.clear();
}

Eigen::Vector2d LinearisationPoints::behind(const Pose& place) const {
  return place_of(place) - place_of(pose_);
}

Eigen::Vector2d LinearisationPoints::shift_to(const CompressedGaussian& gaussian) const {
  Eigen::Vector2d sum = behind(gaussian.pose().mean);
  for (std::size_t slot = 0; slot < landmarks_.size(); ++slot) {
    sum += gaussian.mean_of(slot) - landmarks_[slot];
  }
  return sum / static_cast<double>(1 + landmarks_.size());
}

void LinearisationPoints::shift(const Eigen::Vector2d& way) {
  pose_.x += way(0);
  pose_.y += way(1);
  for (Eigen::Vector2d& landmark : landmarks_) landmark += way;
}

void LinearisationPoints::move(const LinearisedMotion& motion) {
  const Eigen::Vector2d way = -quarter_turned(motion.by_heading);
  pose_ = {pose_.x + way(0), pose_.y + way(1), motion.mean.heading};
}

Eigen::Vector2d turned(const ExpectedObservation& expected, const Eigen::Vector2d& place,
                       const Eigen::Vector2d& landmark) {
  return expected.pose_jacobian.leftCols<2>() * quarter_turned(place) +
         expected.pose_jacobian.col(2) + expected.landmark_jacobian * quarter_turned(landmark);
}

JointBelief::JointBelief(const FilterSetup& setup, Retraction retraction, int iterations,
                         Moments moments, Linearisation linearisation)
    : sensor_(setup.belief.sensor),
      association_(setup),
      gaussian_(setup.belief, retraction, std::min(setup.landmarks, kRoomAtFirst)),
      delayed_(setup.belief),
      iterations_(iterations),
      moments_(moments),
      linearisation_(linearisation),
      retraction_(retraction),
      sigma_(deviations_of(setup.belief.sensor, setup.belief)) {}

void JointBelief::start(const Pose& start) {
  gaussian_.start(start);
  if (is_robocentric()) frame_.start(start, gaussian_);
  association_.clear();
  point_of_.clear();
  delayed_.clear();
  points_.start(start);
  rotation_information_ = 0.0;
  used_detections_.clear();
  outcome_ = {};
}

void JointBelief::update_with(const MotionIncrement& motion, Scan scan) {
  outcome_ = {};
  used_detections_.clear();
  move(motion);
  association_.known() ? association_.pair_by_identity(scan) : pair_nearest(scan);
  select_matched();
  for (std::size_t k = 0; k < scan.size(); ++k) {
    if (association_.pairings()[k].kind == PairingKind::matched) {
      update_with(k, scan[k]);
    } else {
      outcome_.log_likelihood += association_.unmatched_log_density();  // every belief adds it
    }
  }
  if (is_robocentric()) frame_.centre(gaussian_);
}

/// Makes the landmarks that the scan matches near.
void JointBelief::select_matched() {
  matched_.clear();
  for (const Pairing& pairing : association_.pairings()) {
    if (pairing.kind == PairingKind::matched) matched_.push_back(point_of_[pairing.landmark]);
  }
  gaussian_.make_near(matched_);
}

/// Determines which detections of this scan can advance the initialisation of a landmark.
void JointBelief::find_advancing(Scan scan) {
  advancing_.assign(scan.size(), false);
  matched_.clear();
  const auto is_fresh = [&](std::size_t k) {
    return association_.pairings()[k].kind == PairingKind::fresh;
  };
  for (std::size_t k = 0; k < scan.size(); ++k) {
    if (is_fresh(k)) delayed_.add_points_of(scan[k].identity, matched_);
  }
  gaussian_.make_near(matched_);
  for (std::size_t k = 0; k < scan.size(); ++k) {
    if (is_fresh(k)) advancing_[k] = delayed_.can_advance(gaussian_, scan[k]);
  }
}

void JointBelief::add_landmark(const Detection& fresh, std::uint32_t point) {
  association_.add(fresh);
  point_of_.push_back(point);
}

void JointBelief::place_landmark(const Detection& fresh) {
  const std::size_t slot = gaussian_.landmarks();
  add_landmark(fresh, static_cast<std::uint32_t>(slot));
  Eigen::Vector2d behind = Eigen::Vector2d::Zero();
  if (has_own_points()) behind = points_.behind(gaussian_.pose().mean);
  gaussian_.append(vector_of(fresh), behind);
  points_.append(gaussian_.mean_of(slot) - place_of(gaussian_.pose().mean) + behind);
}

void JointBelief::initialise_landmarks(Scan scan) {
  if (!fixes_landmark(sensor_)) find_advancing(scan);
  for (std::size_t k = 0; k < scan.size(); ++k) {
    if (association_.pairings()[k].kind != PairingKind::fresh) continue;
    if (fixes_landmark(sensor_)) {
      place_landmark(scan[k]);
    } else if (advancing_[k]) {
      const auto point = delayed_.advance(gaussian_, scan[k]);
      if (point) add_landmark(scan[k], *point);
    }
  }
}

PoseMoments JointBelief::pose_after(const MotionIncrement& motion) const {
  if (linearisation_ == Linearisation::estimate && moments_ == Moments::map)
    return gaussian_.pose_after(motion);  // called at every control step
  const PoseMoments pose = gaussian_.pose_after(linearised(motion));
  if (is_robocentric()) return frame_.in_map(pose);
  return moments_ == Moments::map ? pose : pushed(pose);
}

std::optional<LandmarkEstimate> JointBelief::landmark(std::size_t k) const {
  const std::size_t at = association_.slot_of(k);
  if (at >= landmarks()) return std::nullopt;
  const std::size_t slot = point_of_[at];
  if (is_robocentric()) return frame_.in_map(gaussian_, slot);
  if (moments_ == Moments::map) return gaussian_.landmark(slot);
  return pushed(gaussian_.point(slot), gaussian_.pose().covariance(2, 2));
}

JointEstimate JointBelief::joint(std::size_t landmarks) const {
  JointEstimate held = gaussian_.joint();
  if (is_robocentric()) frame_.put_in_map(held);
  JointEstimate joint = joint_report(held, association_, landmarks, [&](std::size_t slot) {
    return slot < this->landmarks() ? 3 + row_of(point_of_[slot]) : Eigen::Index{-1};
  });
  if (moments_ == Moments::pushed) push_moments(joint.mean, joint.covariance);
  return joint;
}

/// Greatest distance [m] from the pose of any position that the scan may show; 0 for an empty scan.
double JointBelief::reach_of(Scan scan) const {
  double range = 0.0;
  for (const Detection& detection : scan) {
    const auto distance = distance_in(components_of(sensor_), detection);
    range = std::max(range, distance.value_or(std::numeric_limits<double>::infinity()));
  }
  return range + sensor_.mounting.distance();
}

/// Loops over landmarks first, since the prediction of one serves all detections. Landmarks beyond
/// both gates of all detections are skipped.
void JointBelief::pair_nearest(Scan scan) {
  searches_.assign(scan.size(), {});
  const double range = reach_of(scan);
  const AssociationSettings& settings = association_.settings();
  const double sigmas = std::sqrt(std::max(settings.gate, settings.new_gate));
  const auto drift = gaussian_.drift();
  ExpectedObservation expected;
  for (std::uint32_t landmark = 0; landmark < landmarks(); ++landmark) {
    const std::uint32_t slot = point_of_[landmark];
    if (gaussian_.is_out_of_reach(slot, drift, range, sigmas)) continue;
    if (!look_at(slot, expected)) continue;
    const double log_det = expected.factor.log_det();
    for (std::size_t k = 0; k < scan.size(); ++k) {
      const double distance =
          expected.factor.whiten(expected.innovation(vector_of(scan[k]))).squaredNorm();
      searches_[k].offer(landmark, distance, distance + log_det, settings.gate);
    }
  }
  association_.pair_nearest(scan, searches_);
}

/// Predicts the detection of a landmark; returns false if it cannot be used. A fault is counted.
bool JointBelief::look_at(std::size_t slot, ExpectedObservation& expected) {
  const auto trouble = regresses() ? gaussian_.look_by_sigma_points(slot, expected)
                                   : gaussian_.look_at(slot, expected, observation_point(slot));
  if (trouble == CompressedGaussian::Trouble::faulty) ++outcome_.faults;
  return trouble == CompressedGaussian::Trouble::none;
}

/// Reports the innovation before the detection, while the log-likelihood is that of the last
/// linearisation, which is Laplace's approximation.
void JointBelief::update_with(std::size_t k, const Detection& detection) {
  const std::size_t slot = point_of_[association_.pairings()[k].landmark];
  const Eigen::Vector2d detected = vector_of(detection);
  ExpectedObservation expected;
  if (!look_at(slot, expected)) {
    outcome_.log_likelihood += association_.unmatched_log_density();
    return;
  }
  const ObservationPoint turning = rotation_point(slot);
  used_detections_.push_back({k, expected.innovation(detected), expected.factor.covariance()});
  const auto trouble = gaussian_.update_with(slot, detected, iterations_, expected);
  if (trouble == CompressedGaussian::Trouble::faulty) ++outcome_.faults;
  rotation_information_ += turned(expected, place_of(turning.pose), turning.landmark)
                               .cwiseQuotient(sigma_)
                               .squaredNorm();
  const InnovationFactor& L = expected.factor;
  const double distance = L.whiten(expected.innovation(detected)).squaredNorm();
  outcome_.log_likelihood +=
      log_normal_density(distance, L, static_cast<double>(components_of(sensor_).size()));
}

// The following functions choose the points of linearisation.

Eigen::Vector2d JointBelief::shift_of_points() const {
  if (linearisation_ != Linearisation::constrained) return Eigen::Vector2d::Zero();
  return points_.shift_to(gaussian_);
}

/// A vehicle that has not moved keeps its point, and nothing is linearised.
LinearisedMotion JointBelief::linearised(const MotionIncrement& motion) const {
  if (regresses()) return gaussian_.regressed(motion);
  LinearisedMotion linearised = gaussian_.linearised(motion);
  if (!has_own_points() || stands_still(motion)) return linearised;
  linearised.by_heading +=
      quarter_turned(points_.behind(gaussian_.pose().mean) - shift_of_points());
  return linearised;
}

void JointBelief::move(const MotionIncrement& motion) {
  const LinearisedMotion how = linearised(motion);
  if (linearisation_ == Linearisation::constrained && !stands_still(motion))
    points_.shift(shift_of_points());
  gaussian_.move(how);
  points_.move(how);
}

std::optional<ObservationPoint> JointBelief::observation_point(std::size_t slot) const {
  if (!has_own_points()) return std::nullopt;
  return ObservationPoint{points_.pose(), points_.landmark(slot)};
}

/// The rotation of the invariant error is about the estimate, since its covariance is transformed
/// after every detection. With errors relative to the vehicle, only the frame of the map rotates.
ObservationPoint JointBelief::rotation_point(std::size_t slot) const {
  if (retraction_ == Retraction::invariant || is_robocentric() || !fixes_landmark(sensor_))
    return {gaussian_.pose().mean, gaussian_.mean_of(slot)};
  return {points_.pose(), points_.landmark(slot)};
}

}  // namespace montecarta::filters
