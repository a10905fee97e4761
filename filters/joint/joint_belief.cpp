// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_belief.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::filters {
namespace {

/// Number of landmarks for which memory is reserved at first; identities may be sparse.
constexpr std::size_t kRoomAtFirst = 300;

}  // namespace

bool has_rotation_information(const FilterSetup& setup) {
  return fixes_landmark(setup.belief.sensor) && !setup.map_is_known && !setup.belief.sigma_fix;
}

JointBelief::JointBelief(const FilterSetup& setup, Retraction retraction, int iterations,
                         Moments moments, std::unique_ptr<Linearisation> linearisation)
    : sensor_(setup.belief.sensor),
      association_(setup),
      linearisation_(std::move(linearisation)),
      system_{{setup.belief, retraction, std::min(setup.landmarks, kRoomAtFirst)}, {}},
      delayed_(setup.belief),
      iterations_(iterations),
      moments_(moments),
      retraction_(retraction),
      sigma_(deviations_of(setup.belief.sensor, setup.belief)),
      sigma_fix_(setup.belief.sigma_fix),
      has_rotation_information_(has_rotation_information(setup)) {}

void JointBelief::start(const Prior& prior) {
  const Pose& start = prior.pose.mean;
  system_.gaussian.start(start, prior.pose.covariance);
  linearisation_->start(start, system_.gaussian);
  association_.clear();
  point_of_.clear();
  delayed_.clear();
  system_.points.start(start);
  rotation_information_ = 0.0;
  used_detections_.clear();
  outcome_ = {};
  for (const LandmarkEstimate& known : prior.map) add_known(known);
}

/// Adds the next landmark of a known map, which is independent of the pose and of the others.
void JointBelief::add_known(const LandmarkEstimate& known) {
  const std::size_t slot = landmarks();
  add_landmark(static_cast<std::int32_t>(slot), static_cast<std::uint32_t>(slot));
  system_.gaussian.append(
      NewPoint{.mean = known.mean, .by_pose = Matrix23::Zero(), .noise = known.covariance});
  system_.points.append(known.mean - place_of(system_.points.pose()));
}

void JointBelief::update_with(const MotionIncrement& motion, Scan scan,
                              const std::optional<PositionFix>& fix) {
  outcome_ = {};
  used_detections_.clear();
  linearisation_->move(motion, system_);
  if (fix) update_with(*fix);
  association_.known() ? association_.pair_by_identity(scan) : pair_nearest(scan);
  select_matched();
  for (std::size_t k = 0; k < scan.size(); ++k) {
    if (association_.pairings()[k].kind == PairingKind::matched) {
      update_with(k, scan[k]);
    } else {
      outcome_.log_likelihood += association_.unmatched_log_density();  // every belief adds it
    }
  }
  linearisation_->end_scan(system_.gaussian);
}

/// Updates the belief with a fix, or counts a fault.
void JointBelief::update_with(const PositionFix& fix) {
  double log_density = 0.0;
  const auto status = system_.gaussian.update_with_fix(fix, sigma_fix_.value(), log_density);
  if (status == CompressedGaussian::ObservationStatus::faulty) ++outcome_.faults;
  outcome_.log_likelihood += log_density;
}

/// Makes the landmarks that the scan matches near.
void JointBelief::select_matched() {
  matched_.clear();
  for (const Pairing& pairing : association_.pairings()) {
    if (pairing.kind == PairingKind::matched) matched_.push_back(point_of_[pairing.landmark]);
  }
  system_.gaussian.make_near(matched_);
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
  system_.gaussian.make_near(matched_);
  for (std::size_t k = 0; k < scan.size(); ++k) {
    if (is_fresh(k)) advancing_[k] = delayed_.can_advance(system_.gaussian, scan[k]);
  }
}

void JointBelief::add_landmark(std::int32_t identity, std::uint32_t point) {
  association_.add(identity);
  point_of_.push_back(point);
}

void JointBelief::place_landmark(const Detection& fresh) {
  CompressedGaussian& gaussian = system_.gaussian;
  const std::size_t slot = gaussian.landmarks();
  add_landmark(fresh.identity, static_cast<std::uint32_t>(slot));
  const Eigen::Vector2d offset = linearisation_->offset(system_);
  gaussian.append(vector_of(fresh), offset);
  system_.points.append(gaussian.mean_of(slot) - place_of(gaussian.pose().mean) + offset);
}

void JointBelief::initialise_landmarks(Scan scan) {
  if (!fixes_landmark(sensor_)) find_advancing(scan);
  for (std::size_t k = 0; k < scan.size(); ++k) {
    if (association_.pairings()[k].kind != PairingKind::fresh) continue;
    if (fixes_landmark(sensor_)) {
      place_landmark(scan[k]);
    } else if (advancing_[k]) {
      const auto point = delayed_.advance(system_.gaussian, scan[k]);
      if (point) add_landmark(scan[k].identity, *point);
    }
  }
}

PoseMoments JointBelief::pose_after(const MotionIncrement& motion) const {
  if (moments_ == Moments::map) return linearisation_->pose_after(system_, motion);
  return pushed(system_.gaussian.pose_after(linearisation_->linearised(system_, motion)));
}

std::optional<LandmarkEstimate> JointBelief::landmark(std::size_t k) const {
  const std::size_t at = association_.slot_of(k);
  if (at >= landmarks()) return std::nullopt;
  const CompressedGaussian& gaussian = system_.gaussian;
  const std::size_t slot = point_of_[at];
  if (moments_ == Moments::map) return linearisation_->landmark(gaussian, slot);
  return pushed(gaussian.point(slot), gaussian.pose().covariance(2, 2));
}

JointEstimate JointBelief::joint(std::size_t landmarks) const {
  JointEstimate held = system_.gaussian.joint();
  linearisation_->put_in_map(held);
  JointEstimate joint = joint_report(held, association_, landmarks, [&](std::size_t slot) {
    return slot < this->landmarks() ? 3 + row_of(point_of_[slot]) : Eigen::Index{-1};
  });
  if (moments_ == Moments::pushed) push_moments(joint.mean, joint.covariance);
  return joint;
}

/// Largest distance [m] from the pose at which the scan may show a position; infinite if a
/// detection determines no distance.
double JointBelief::reach_of(Scan scan) const {
  double range = 0.0;
  for (const Detection& detection : scan) {
    const auto distance = distance_in(components_of(sensor_), detection);
    range = std::max(range, distance.value_or(std::numeric_limits<double>::infinity()));
  }
  return range + sensor_.mounting.distance();
}

/// Pairs the scan by nearest neighbour. The outer loop is over landmarks, since the prediction of
/// one serves all detections. Landmarks beyond both gates of all detections are skipped.
void JointBelief::pair_nearest(Scan scan) {
  searches_.assign(scan.size(), {});
  const double range = reach_of(scan);
  const AssociationSettings& settings = association_.settings();
  const double sigmas = std::sqrt(std::max(settings.gate, settings.new_gate));
  const auto drift = system_.gaussian.drift();
  ExpectedObservation expected;
  for (std::uint32_t landmark = 0; landmark < landmarks(); ++landmark) {
    const std::uint32_t slot = point_of_[landmark];
    if (system_.gaussian.is_out_of_reach(slot, drift, range, sigmas)) continue;
    if (!predict(slot, expected)) continue;
    const double log_det = expected.factor.log_det();
    for (std::size_t k = 0; k < scan.size(); ++k) {
      const double distance =
          expected.factor.whiten(expected.innovation(vector_of(scan[k]))).squaredNorm();
      searches_[k].offer(landmark, distance, distance + log_det, settings.gate);
    }
  }
  association_.pair_nearest(scan, searches_);
}

/// Predicts the detection of a landmark, and counts a fault. Returns false if the prediction cannot
/// be used.
bool JointBelief::predict(std::size_t slot, ExpectedObservation& expected) {
  const auto status = linearisation_->predict(system_, slot, expected);
  if (status == CompressedGaussian::ObservationStatus::faulty) ++outcome_.faults;
  return status == CompressedGaussian::ObservationStatus::usable;
}

/// Updates the belief with a detection. It reports the innovation before the detection, while the
/// log-likelihood is that of the last linearisation, which is Laplace's approximation.
void JointBelief::update_with(std::size_t k, const Detection& detection) {
  const std::size_t slot = point_of_[association_.pairings()[k].landmark];
  const Eigen::Vector2d detected = vector_of(detection);
  ExpectedObservation expected;
  if (!predict(slot, expected)) {
    outcome_.log_likelihood += association_.unmatched_log_density();
    return;
  }
  const ObservationPoint turning = rotation_point(slot);
  used_detections_.push_back({k, expected.innovation(detected), expected.factor.covariance()});
  const double heading = system_.gaussian.pose().mean.heading;
  const auto status = system_.gaussian.update_with(slot, detected, iterations_, expected);
  if (status == CompressedGaussian::ObservationStatus::faulty) ++outcome_.faults;
  rotation_information_ += turned(expected, place_of(turning.pose), turning.landmark)
                               .cwiseQuotient(sigma_)
                               .squaredNorm();
  if (retraction_ == Retraction::left_invariant)
    system_.points.turn(wrap(system_.gaussian.pose().mean.heading - heading));
  const InnovationFactor& L = expected.factor;
  const double distance = L.whiten(expected.innovation(detected)).squaredNorm();
  outcome_.log_likelihood +=
      log_normal_density(distance, L, static_cast<double>(components_of(sensor_).size()));
}

/// Returns the points about which the system rotates. The rotation of the right-invariant error is
/// about the estimate, since its covariance is transformed after every detection.
ObservationPoint JointBelief::rotation_point(std::size_t slot) const {
  if (retraction_ == Retraction::right_invariant || !fixes_landmark(sensor_))
    return {system_.gaussian.pose().mean, system_.gaussian.mean_of(slot)};
  return linearisation_->rotation_point(system_, slot);
}

}  // namespace montecarta::filters
