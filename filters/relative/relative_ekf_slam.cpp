// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/relative_ekf_slam.hpp"

#include "filters/association/map_association.hpp"
#include "filters/joint/joint_gaussian.hpp"
#include "filters/moments/control_motion.hpp"
#include "filters/relative/relative_gaussian.hpp"

#include <algorithm>
#include <optional>
#include <vector>

namespace montecarta::filters {
namespace {

/// EKF-SLAM in relative coordinates (EQUATIONS 22): a joint Gaussian of the displacements between
/// the poses that initialised landmarks, and of the landmarks in the frames of these poses. In
/// these coordinates the posterior is nearly Gaussian even if the heading in the map is uncertain.
/// All other poses are integrated out, and a scan is linearised only when it is conditioned on.
class RelativeEkfSlam final : public SlamFilter {
 public:
  explicit RelativeEkfSlam(const FilterSetup& setup)
      : model_(setup.belief),
        motion_kind_(motion_of(setup.options)),
        most_frames_(setup.options.integer("frames")),
        iterations_(static_cast<int>(setup.options.integer("iterations"))),
        most_bend_(setup.options.number("bend") *
                   length_deviation(setup.belief.sensor, setup.belief, 0.0)),
        lag_(setup.options.integer("lag")),
        association_(setup),
        sensor_(setup.belief),
        gaussian_(sensor_),
        joined_(gaussian_),
        moved_(gaussian_) {}

  void start(const Pose& start) override {
    association_.clear();
    motion_.restart();
    is_at_scan_ = true;
    gaussian_.start(start);
    report_ = {};
  }
  void predict(const StepContext& /*context*/, const Control& control, double duration) override {
    is_at_scan_ = false;
    advance(motion_, control, duration, model_, motion_kind_);
  }
  void update(const StepContext& /*context*/, Scan scan) override {
    report_ = {};
    if (gaussian_.has_duplicates()) joined_.move(motion_);
    gaussian_.move(motion_);
    motion_.restart();
    is_at_scan_ = true;
    association_.known() ? association_.pair_by_identity(scan) : pair_nearest(scan);
    report_.association = association_.counts();
    condition(scan);
    initialise_landmarks(scan);
    merge_duplicates();
    report_.map_size = static_cast<double>(gaussian_.chain().landmarks.size());
  }
  PoseEstimate estimate() const override {
    points_.clear();
    if (!is_at_scan_) {
      moved_ = reported();
      moved_.move(motion_);
    }
    const JointEstimate pose = moments_of(is_at_scan_ ? reported() : moved_);
    return {PoseMoments{Pose{pose.mean(0), pose.mean(1), pose.mean(2)}, pose.covariance},
            std::nullopt};
  }
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    const JointEstimate held = held_joint();
    for (std::size_t k = 0; k < landmarks.size(); ++k) {
      const std::size_t slot = association_.slot_of(k);
      landmarks[k].reset();
      if (slot >= points_.size()) continue;
      const Eigen::Index row = 3 + row_of(slot);
      landmarks[k] =
          LandmarkEstimate{held.mean.segment<2>(row), held.covariance.block<2, 2>(row, row)};
    }
  }
  std::optional<JointEstimate> joint(std::size_t landmarks) const override {
    const JointEstimate held = held_joint();
    return joint_report(held, association_, landmarks, [&](std::size_t slot) {
      return slot < points_.size() ? 3 + row_of(slot) : Eigen::Index{-1};
    });
  }

 private:
  /// Associates by the estimates that are reported.
  void pair_nearest(Scan scan) {
    searches_.assign(scan.size(), {});
    reported().expect_all([&](std::size_t landmark, const Eigen::Vector2d& expected,
                              const Eigen::Matrix2d& covariance) {
      const auto L = factor(covariance);
      if (!L) {
        ++report_.numerical_faults;
        return;
      }
      for (std::size_t k = 0; k < scan.size(); ++k) {
        const Eigen::Vector2d innovation = sensor_.residual(vector_of(scan[k]), expected);
        const double distance = L->whiten(innovation).squaredNorm();
        searches_[k].offer(static_cast<std::uint32_t>(landmark), distance, distance + L->log_det(),
                           association_.settings().gate);
      }
    });
    association_.pair_nearest(scan, searches_);
  }

  /// Conditions on the detections of landmarks with a path that is straight enough. The other
  /// landmarks will be initialised again.
  void condition(Scan scan) {
    seen_.clear();
    duplicates_.clear();
    gaussian_.bends(bends_);
    for (std::size_t k = 0; k < scan.size(); ++k) {
      const Pairing& pairing = association_.pairings()[k];
      if (pairing.kind != PairingKind::matched) {
        report_.log_likelihood += association_.unmatched_log_density();
        continue;
      }
      (is_bent(pairing.landmark) ? duplicates_ : seen_)
          .push_back({pairing.landmark, vector_of(scan[k])});
    }
    const RelativeOutcome outcome = gaussian_.see(seen_, iterations_);
    if (outcome.is_faulty) ++report_.numerical_faults;
    report_.nis = outcome.nis;
    report_.nis_dof = outcome.dof;
    report_.log_likelihood += outcome.log_likelihood;
  }

  /// Returns whether a detection of the landmark would be strongly nonlinear (EQUATIONS (22.4)).
  bool is_bent(std::size_t landmark) const {
    const auto& [first, again] = gaussian_.chain().landmarks[landmark];
    return !again && bends_[first.frame] > most_bend_;
  }
  void initialise_landmarks(Scan scan) {
    const auto is_fresh = [](const Pairing& pairing) { return pairing.kind == PairingKind::fresh; };
    const bool any = !duplicates_.empty() || std::ranges::any_of(association_.pairings(), is_fresh);
    const bool has_room = gaussian_.chain().displacements.size() < most_frames_;
    if (any && !gaussian_.is_at_newest_frame() && (has_room || gaussian_.drop_empty_frame()))
      gaussian_.add_frame();
    if (!gaussian_.has_duplicates()) waited_ = 0;
    for (const RelativeGaussian::Seen& seen : duplicates_) gaussian_.add_duplicate(seen);
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (!is_fresh(association_.pairings()[k])) continue;
      association_.add(scan[k].identity);
      gaussian_.add_landmark(vector_of(scan[k]));
    }
  }
  void merge_duplicates() {
    if (!gaussian_.has_duplicates()) return;
    bool is_joined;
    if (waited_++ < lag_) {
      joined_ = gaussian_;
      is_joined = joined_.condition_on_equality(iterations_);
    } else {
      is_joined = gaussian_.merge_duplicates(iterations_);
    }
    if (!is_joined) ++report_.numerical_faults;
  }
  const RelativeGaussian& reported() const {
    return gaussian_.has_duplicates() ? joined_ : gaussian_;
  }

  /// Moments of the pose and of `points_`.
  JointEstimate moments_of(const RelativeGaussian& gaussian) const {
    return moments_.of(gaussian.chain(), gaussian.mean(), gaussian.covariance(), points_);
  }

  /// Moments of the pose and all landmarks in order of initialisation; `points_` become the latter.
  JointEstimate held_joint() const {
    points_.clear();
    for (std::size_t slot = 0; slot < reported().chain().landmarks.size(); ++slot)
      points_.push_back(reported().point(slot));
    return moments_of(reported());
  }

  Belief model_;
  Motion motion_kind_;
  std::size_t most_frames_;
  int iterations_;
  double most_bend_;  ///< [m] bend of the path beyond which a landmark is initialised again
  std::size_t lag_;   ///< [scans] time until both initialisations of a landmark are joined
  MapAssociation association_;
  MotionIncrement motion_;  ///< motion since the last scan
  bool is_at_scan_ = true;  ///< true if no motion followed the last scan
  BelievedSensor sensor_;
  RelativeGaussian gaussian_;
  RelativeGaussian joined_;  ///< copy in which the landmarks that were initialised again are joined
  std::size_t waited_ = 0;   ///< [scans] time since a landmark was initialised again
  std::vector<RelativeGaussian::Seen>
      duplicates_;                            ///< detections of landmarks to be initialised again
  std::vector<double> bends_;                 ///< {frame} RelativeGaussian::bends()
  std::vector<RelativeGaussian::Seen> seen_;  ///< detections to be used
  std::vector<NearestSearch> searches_;       ///< scratch, like the next three
  mutable RelativeGaussian moved_;
  mutable ChainMoments moments_;
  mutable std::vector<RelativeChain::Point> points_;
  ScanReport report_;
};

}  // namespace

FilterKind relative_ekf_slam_kind() {
  return {
      .name = "relative_ekf_slam",
      .long_name = "EKF-SLAM in relative coordinates",
      .source = "EQUATIONS 22",
      .reports = {.joint = true},
      .options =
          {count_parameter(
               "frames", "40", 1, 10000,
               "largest number of poses whose frames landmarks are held in; when all of them have "
               "landmarks the filter continues as EKF-SLAM in the last one"),
           number_parameter(
               "bend", "0.3", 0, 1e9,
               "standard deviations of a range by which uncertain headings may bend the way to a "
               "landmark; beyond that the landmark is initialised again (EQUATIONS (22.4))"),
           count_parameter("lag", "50", 0, 1000000,
                           "number of scans after which landmarks that were initialised again are "
                           "joined with their earlier estimates"),
           count_parameter(
               "iterations", "20", 0, 100,
               "number of times that a scan is linearised again at the updated estimate"),
           fitting_motion_option()},
      .sensors = {RangeBearingSensor::kName, PositionSensor::kName},
      .takes_mountings = true,
      .make = [](const FilterSetup& setup) { return std::make_unique<RelativeEkfSlam>(setup); }};
}

}  // namespace montecarta::filters
