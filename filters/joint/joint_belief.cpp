// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_belief.hpp"

#include "engine/errors.hpp"
#include "filters/association/association_counts.hpp"
#include "filters/joint/packs.hpp"
#include "filters/models/eigen_jacobians.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace montecarta {
namespace {

/// Landmarks that are reserved before any is seen; identities may be sparse.
constexpr std::size_t kRoomAtFirst = 300;
constexpr std::uint32_t kUnseen = std::numeric_limits<std::uint32_t>::max();

}  // namespace

JointBelief::JointBelief(const FilterSetup& setup, Retraction retraction, int iterations)
    : association_(setup.association),
      log_new_density_(log_new_density(setup.association, setup.belief)),
      gaussian_(setup.belief, retraction, std::min(setup.landmarks, kRoomAtFirst)),
      iterations_(iterations),
      slot_of_identity_(setup.landmarks, kUnseen) {}

void JointBelief::start(const Pose& start) {
  gaussian_.start(start);
  std::fill(slot_of_identity_.begin(), slot_of_identity_.end(), kUnseen);
  made_of_.clear();
  sightings_.clear();
  outcome_ = {};
}

void JointBelief::become(const JointBelief& other) {
  gaussian_.become(other.gaussian_);
  slot_of_identity_ = other.slot_of_identity_;
  made_of_ = other.made_of_;
  pairings_ = other.pairings_;
  sightings_ = other.sightings_;
  outcome_ = other.outcome_;
}

void JointBelief::absorb(const MotionIncrement& motion, Scan scan) {
  outcome_ = {};
  sightings_.clear();
  gaussian_.move(motion);
  associate(scan);
  outcome_.association = association_counts(scan, pairings_, made_of_);
  attend();
  for (std::size_t k = 0; k < scan.size(); ++k) {
    if (pairings_[k].verdict == Verdict::matched) {
      absorb(k, scan[k]);
    } else if (!known()) {
      outcome_.log_likelihood += log_new_density_;  // as every belief does (EQUATIONS 17)
    }
  }
}

/// Readies the Gaussian for the landmarks that the scan shows.
void JointBelief::attend() {
  matched_.clear();
  for (const Pairing& pairing : pairings_) {
    if (pairing.verdict == Verdict::matched) matched_.push_back(pairing.landmark);
  }
  gaussian_.attend(matched_);
}

void JointBelief::give_birth(Scan scan) {
  for (std::size_t k = 0; k < scan.size(); ++k) {
    if (pairings_[k].verdict == Verdict::fresh) give_birth(scan[k]);
  }
}

/// Where the map holds landmark k of landmark(); any number beyond the map's size where it does
/// not.
std::size_t JointBelief::slot_of(std::size_t k) const {
  if (!known()) return k;
  return k < slot_of_identity_.size() ? slot_of_identity_[k] : kUnseen;
}

std::optional<LandmarkEstimate> JointBelief::landmark(std::size_t k) const {
  const std::size_t slot = slot_of(k);
  return slot < gaussian_.landmarks() ? std::optional(gaussian_.landmark(slot)) : std::nullopt;
}

JointEstimate JointBelief::joint(std::size_t landmarks) const {
  std::vector<Eigen::Index> rows{0, 1, 2}, places{0, 1, 2};  ///< and where they go in the result
  rows.reserve(3 + 2 * landmarks);
  places.reserve(3 + 2 * landmarks);
  for (std::size_t k = 0; k < landmarks; ++k) {
    const std::size_t slot = slot_of(k);
    if (slot >= gaussian_.landmarks()) continue;
    for (const Eigen::Index coordinate : {0, 1}) {
      rows.push_back(3 + row_of(slot) + coordinate);
      places.push_back(3 + row_of(k) + coordinate);
    }
  }
  const JointEstimate by_birth = gaussian_.joint();
  const Eigen::Index size = 3 + row_of(landmarks);
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  JointEstimate joint{Eigen::VectorXd::Constant(size, unknown),
                      Eigen::MatrixXd::Constant(size, size, unknown)};
  for (std::size_t a = 0; a < rows.size(); ++a) {
    joint.mean(places[a]) = by_birth.mean(rows[a]);
    for (std::size_t b = 0; b < rows.size(); ++b) {
      joint.covariance(places[a], places[b]) = by_birth.covariance(rows[a], rows[b]);
    }
  }
  return joint;
}

void JointBelief::associate(Scan scan) {
  pairings_.assign(scan.size(), {});
  if (known()) {
    for (std::size_t k = 0; k < scan.size(); ++k) pairings_[k] = pairing_by_identity(scan[k]);
  } else {
    pair_nearest(scan);
  }
}

Pairing JointBelief::pairing_by_identity(const Detection& detection) const {
  if (detection.identity == Detection::kClutter) return {};
  const std::size_t slot = slot_of(static_cast<std::size_t>(detection.identity));
  if (slot == kUnseen) return {.verdict = Verdict::fresh};
  return {.verdict = Verdict::matched, .landmark = static_cast<std::uint32_t>(slot)};
}

/// Landmark by landmark, since what is expected of one serves all detections. What is beyond both
/// gates of all of them need not be looked at.
void JointBelief::pair_nearest(Scan scan) {
  searches_.assign(scan.size(), {});
  double range = 0.0;
  for (const Detection& detection : scan) range = std::max(range, detection.range);
  const double sigmas = std::sqrt(std::max(association_.gate, association_.new_gate));
  const auto drift = gaussian_.drift();
  ExpectedSight expected;
  for (std::uint32_t slot = 0; slot < gaussian_.landmarks(); ++slot) {
    if (gaussian_.is_out_of_reach(slot, drift, range, sigmas)) continue;
    if (!look_at(slot, expected)) continue;
    const double log_det = expected.factor.log_det();
    for (std::size_t k = 0; k < scan.size(); ++k) {
      const double distance =
          expected.factor.whiten(expected.innovation(sight_of(scan[k]))).squaredNorm();
      searches_[k].offer(slot, distance, distance + log_det, association_.gate);
    }
  }
  for (std::size_t k = 0; k < scan.size(); ++k) pairings_[k] = judge(searches_[k], association_);
  exclude_rivals(pairings_);
}

/// False where the landmark gives nothing to weigh by; a fault is counted.
bool JointBelief::look_at(std::size_t slot, ExpectedSight& expected) {
  const auto trouble = gaussian_.look_at(slot, expected);
  if (trouble == CompressedGaussian::Trouble::faulty) ++outcome_.faults;
  return trouble == CompressedGaussian::Trouble::none;
}

/// Counted is the innovation against the belief before the detection; weighed by is that of the
/// last linearisation, with which the density of the detection is that of Laplace.
void JointBelief::absorb(std::size_t k, const Detection& detection) {
  const std::size_t slot = pairings_[k].landmark;
  const RangeBearing<double> detected = sight_of(detection);
  ExpectedSight expected;
  if (!look_at(slot, expected)) {
    if (!known()) outcome_.log_likelihood += log_new_density_;
    return;
  }
  sightings_.push_back({k, expected.innovation(detected), expected.factor.covariance()});
  const auto trouble = gaussian_.absorb(slot, detected, iterations_, expected);
  if (trouble == CompressedGaussian::Trouble::faulty) ++outcome_.faults;
  const InnovationFactor& L = expected.factor;
  const double distance = L.whiten(expected.innovation(detected)).squaredNorm();
  outcome_.log_likelihood += log_normal_density(distance, L);
}

void JointBelief::give_birth(const Detection& detection) {
  expect_room_to_grow();
  if (known()) {
    const auto identity = static_cast<std::size_t>(detection.identity);
    if (identity >= slot_of_identity_.size()) slot_of_identity_.resize(identity + 1, kUnseen);
    slot_of_identity_[identity] = static_cast<std::uint32_t>(gaussian_.landmarks());
  }
  gaussian_.append(sight_of(detection));
  made_of_.push_back(detection.identity);
}

void JointBelief::expect_room_to_grow() const {
  if (known() || gaussian_.landmarks() < association_.most_landmarks) return;
  throw RunError("the map grew beyond " + std::to_string(association_.most_landmarks) +
                 " landmarks");
}

}  // namespace montecarta
