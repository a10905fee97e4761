// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_belief.hpp"

#include "filters/models/eigen_jacobians.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::filters {
namespace {

/// Landmarks that are reserved before any is seen; identities may be sparse.
constexpr std::size_t kRoomAtFirst = 300;

}  // namespace

JointBelief::JointBelief(const FilterSetup& setup, Retraction retraction, int iterations)
    : association_(setup),
      gaussian_(setup.belief, retraction, std::min(setup.landmarks, kRoomAtFirst)),
      iterations_(iterations) {}

void JointBelief::start(const Pose& start) {
  gaussian_.start(start);
  association_.clear();
  used_detections_.clear();
  outcome_ = {};
}

void JointBelief::become(const JointBelief& other) {
  gaussian_.become(other.gaussian_);
  association_ = other.association_;
  used_detections_ = other.used_detections_;
  outcome_ = other.outcome_;
}

void JointBelief::update_with(const MotionIncrement& motion, Scan scan) {
  outcome_ = {};
  used_detections_.clear();
  gaussian_.move(motion);
  association_.known() ? association_.pair_by_identity(scan) : pair_nearest(scan);
  select_matched();
  for (std::size_t k = 0; k < scan.size(); ++k) {
    if (association_.pairings()[k].kind == PairingKind::matched) {
      update_with(k, scan[k]);
    } else {
      outcome_.log_likelihood += association_.unmatched_log_density();  // as every belief does
    }
  }
}

/// Readies the Gaussian for the landmarks that the scan shows.
void JointBelief::select_matched() {
  matched_.clear();
  for (const Pairing& pairing : association_.pairings()) {
    if (pairing.kind == PairingKind::matched) matched_.push_back(pairing.landmark);
  }
  gaussian_.make_near(matched_);
}

void JointBelief::initialise_landmarks(Scan scan) {
  for (std::size_t k = 0; k < scan.size(); ++k) {
    if (association_.pairings()[k].kind != PairingKind::fresh) continue;
    association_.add(scan[k]);
    gaussian_.append(observation_of(scan[k]));
  }
}

std::optional<LandmarkEstimate> JointBelief::landmark(std::size_t k) const {
  const std::size_t slot = association_.slot_of(k);
  return slot < gaussian_.landmarks() ? std::optional(gaussian_.landmark(slot)) : std::nullopt;
}

JointEstimate JointBelief::joint(std::size_t landmarks) const {
  std::vector<Eigen::Index> rows{0, 1, 2}, places{0, 1, 2};  ///< and where they go in the result
  rows.reserve(3 + 2 * landmarks);
  places.reserve(3 + 2 * landmarks);
  for (std::size_t k = 0; k < landmarks; ++k) {
    const std::size_t slot = association_.slot_of(k);
    if (slot >= gaussian_.landmarks()) continue;
    for (const Eigen::Index coordinate : {0, 1}) {
      rows.push_back(3 + row_of(slot) + coordinate);
      places.push_back(3 + row_of(k) + coordinate);
    }
  }
  const JointEstimate by_order = gaussian_.joint();
  const Eigen::Index size = 3 + row_of(landmarks);
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  JointEstimate joint{Eigen::VectorXd::Constant(size, unknown),
                      Eigen::MatrixXd::Constant(size, size, unknown)};
  for (std::size_t a = 0; a < rows.size(); ++a) {
    joint.mean(places[a]) = by_order.mean(rows[a]);
    for (std::size_t b = 0; b < rows.size(); ++b) {
      joint.covariance(places[a], places[b]) = by_order.covariance(rows[a], rows[b]);
    }
  }
  return joint;
}

/// Landmark by landmark, since what is expected of one serves all detections. What is beyond both
/// gates of all of them need not be looked at.
void JointBelief::pair_nearest(Scan scan) {
  searches_.assign(scan.size(), {});
  double range = 0.0;
  for (const Detection& detection : scan) range = std::max(range, detection.range);
  const AssociationSettings& settings = association_.settings();
  const double sigmas = std::sqrt(std::max(settings.gate, settings.new_gate));
  const auto drift = gaussian_.drift();
  ExpectedObservation expected;
  for (std::uint32_t slot = 0; slot < gaussian_.landmarks(); ++slot) {
    if (gaussian_.is_out_of_reach(slot, drift, range, sigmas)) continue;
    if (!look_at(slot, expected)) continue;
    const double log_det = expected.factor.log_det();
    for (std::size_t k = 0; k < scan.size(); ++k) {
      const double distance =
          expected.factor.whiten(expected.innovation(observation_of(scan[k]))).squaredNorm();
      searches_[k].offer(slot, distance, distance + log_det, settings.gate);
    }
  }
  association_.pair_nearest(scan, searches_);
}

/// False where the landmark gives nothing to weigh by; a fault is counted.
bool JointBelief::look_at(std::size_t slot, ExpectedObservation& expected) {
  const auto trouble = gaussian_.look_at(slot, expected);
  if (trouble == CompressedGaussian::Trouble::faulty) ++outcome_.faults;
  return trouble == CompressedGaussian::Trouble::none;
}

/// Counted is the innovation against the belief before the detection; weighed by is that of the
/// last linearisation, with which the density of the detection is that of Laplace.
void JointBelief::update_with(std::size_t k, const Detection& detection) {
  const std::size_t slot = association_.pairings()[k].landmark;
  const RangeBearing<double> detected = observation_of(detection);
  ExpectedObservation expected;
  if (!look_at(slot, expected)) {
    outcome_.log_likelihood += association_.unmatched_log_density();
    return;
  }
  used_detections_.push_back({k, expected.innovation(detected), expected.factor.covariance()});
  const auto trouble = gaussian_.update_with(slot, detected, iterations_, expected);
  if (trouble == CompressedGaussian::Trouble::faulty) ++outcome_.faults;
  const InnovationFactor& L = expected.factor;
  const double distance = L.whiten(expected.innovation(detected)).squaredNorm();
  outcome_.log_likelihood += log_normal_density(distance, L);
}

}  // namespace montecarta::filters
