// SPDX-License-Identifier: BSD-3-Clause
#include "filters/ekf_slam/ekf_slam.hpp"

#include "engine/errors.hpp"
#include "filters/association/association_counts.hpp"
#include "filters/association/nearest.hpp"
#include "filters/ekf_slam/joint_gaussian.hpp"
#include "filters/models/eigen_jacobians.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace montecarta {
namespace {

/// Landmarks that are reserved before any is seen; identities may be sparse.
constexpr std::size_t kRoomAtFirst = 300;
constexpr std::uint32_t kUnseen = std::numeric_limits<std::uint32_t>::max();

Eigen::Vector2d innovation_of(const Detection& detection, const ExpectedSight& expected) {
  return to_vector(residual(sight_of(detection), expected.sight.sight));
}

class EkfSlam final : public SlamFilter {
 public:
  EkfSlam(const FilterSetup& setup, Retraction retraction)
      : association_(setup.association),
        log_new_density_(log_new_density(setup.association, setup.belief)),
        gaussian_(setup.belief, retraction, std::min(setup.landmarks, kRoomAtFirst)),
        slot_of_identity_(setup.landmarks, kUnseen) {}

  void start(const Pose& start) override {
    gaussian_.start(start);
    std::fill(slot_of_identity_.begin(), slot_of_identity_.end(), kUnseen);
    made_of_.clear();
    report_ = {};
  }

  void predict(const StepContext&, const Control& control, double duration) override {
    gaussian_.move(control, duration);
  }

  void update(const StepContext&, Scan scan) override {
    report_ = {};
    gaussian_.finish_motion();
    associate(scan);
    report_.association = association_counts(scan, pairings_, made_of_);
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (pairings_[k].verdict == Verdict::matched) {
        absorb(scan[k], pairings_[k].landmark);
      } else if (!known()) {
        report_.log_likelihood += log_new_density_;  // as every particle does (SPEC 17)
      }
    }
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (pairings_[k].verdict == Verdict::fresh) give_birth(scan[k]);
    }
    report_.map_size = static_cast<double>(gaussian_.landmarks());
  }

  PoseEstimate estimate() const override { return {gaussian_.pose(), std::nullopt}; }
  const ScanReport& report() const override { return report_; }

  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    for (std::size_t k = 0; k < landmarks.size(); ++k) {
      const std::size_t slot = slot_of(k);
      landmarks[k] =
          slot < gaussian_.landmarks() ? std::optional(gaussian_.landmark(slot)) : std::nullopt;
    }
  }

 private:
  bool known() const { return association_.kind == Association::known; }

  /// Where the map holds row k of map(); any number beyond the map's size where it does not.
  std::size_t slot_of(std::size_t k) const {
    if (!known()) return k;
    return k < slot_of_identity_.size() ? slot_of_identity_[k] : kUnseen;
  }

  void associate(Scan scan) {
    pairings_.assign(scan.size(), {});
    if (known()) {
      for (std::size_t k = 0; k < scan.size(); ++k) pairings_[k] = pairing_by_identity(scan[k]);
    } else {
      pair_nearest(scan);
    }
  }

  Pairing pairing_by_identity(const Detection& detection) const {
    if (detection.identity == Detection::kClutter) return {};
    const std::size_t slot = slot_of(static_cast<std::size_t>(detection.identity));
    if (slot == kUnseen) return {.verdict = Verdict::fresh};
    return {.verdict = Verdict::matched, .landmark = static_cast<std::uint32_t>(slot)};
  }

  /// Landmark by landmark, since what is expected of one serves all detections.
  void pair_nearest(Scan scan) {
    searches_.assign(scan.size(), {});
    ExpectedSight expected;
    for (std::uint32_t slot = 0; slot < gaussian_.landmarks(); ++slot) {
      if (!look_at(slot, expected)) continue;
      const double log_det = expected.innovation.log_det();
      for (std::size_t k = 0; k < scan.size(); ++k) {
        const double distance =
            expected.innovation.whiten(innovation_of(scan[k], expected)).squaredNorm();
        searches_[k].offer(slot, distance, distance + log_det, association_.gate);
      }
    }
    for (std::size_t k = 0; k < scan.size(); ++k) pairings_[k] = judge(searches_[k], association_);
    exclude_rivals(pairings_);
  }

  /// False where the landmark gives nothing to weigh by; a fault is counted.
  bool look_at(std::size_t slot, ExpectedSight& expected) {
    const auto trouble = gaussian_.look_at(slot, expected);
    if (trouble == JointGaussian::Trouble::faulty) ++report_.numerical_faults;
    return trouble == JointGaussian::Trouble::none;
  }

  void absorb(const Detection& detection, std::size_t slot) {
    ExpectedSight expected;
    if (!look_at(slot, expected)) return;
    const double distance = gaussian_.absorb(slot, expected, innovation_of(detection, expected));
    report_.nis += distance;
    report_.nis_dof += 2;
    report_.log_likelihood += log_normal_density(distance, expected.innovation);
  }

  void give_birth(const Detection& detection) {
    expect_room_to_grow();
    if (known()) {
      const auto identity = static_cast<std::size_t>(detection.identity);
      if (identity >= slot_of_identity_.size()) slot_of_identity_.resize(identity + 1, kUnseen);
      slot_of_identity_[identity] = static_cast<std::uint32_t>(gaussian_.landmarks());
    }
    gaussian_.append(sight_of(detection));
    made_of_.push_back(detection.identity);
  }

  void expect_room_to_grow() const {
    if (known() || gaussian_.landmarks() < association_.most_landmarks) return;
    throw RunError("the map grew beyond " + std::to_string(association_.most_landmarks) +
                   " landmarks");
  }

  AssociationSettings association_;
  double log_new_density_;
  JointGaussian gaussian_;
  std::vector<std::uint32_t> slot_of_identity_;  ///< known association only
  std::vector<std::int32_t> made_of_;            ///< {slot} identity at birth, to count errors
  std::vector<Pairing> pairings_;                ///< of the current scan
  std::vector<NearestSearch> searches_;
  ScanReport report_;
};

}  // namespace

std::unique_ptr<SlamFilter> make_ekf_slam(const FilterSetup& setup) {
  return std::make_unique<EkfSlam>(setup, Retraction::additive);
}

std::unique_ptr<SlamFilter> make_riekf_slam(const FilterSetup& setup) {
  return std::make_unique<EkfSlam>(setup, Retraction::invariant);
}

FilterKind ekf_slam_kind() {
  return {.name = "ekf_slam",
          .long_name = "EKF-SLAM",
          .source = "Smith, Self, Cheeseman 1990; SPEC 24 with one component",
          .has_particles = false,
          .has_mixture = false,
          .options = {},
          .make = make_ekf_slam};
}

FilterKind riekf_slam_kind() {
  return {.name = "riekf_slam",
          .long_name = "right-invariant EKF-SLAM",
          .source = "Barrau, Bonnabel 2015",
          .has_particles = false,
          .has_mixture = false,
          .options = {},
          .make = make_riekf_slam};
}

}  // namespace montecarta
