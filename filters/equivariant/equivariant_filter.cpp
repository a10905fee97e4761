// SPDX-License-Identifier: BSD-3-Clause
#include "filters/equivariant/equivariant_filter.hpp"

#include "filters/association/map_association.hpp"
#include "filters/equivariant/polar_gaussian.hpp"
#include "filters/moments/control_motion.hpp"
#include "filters/population/population.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

namespace montecarta::filters {
namespace {

/// The equivariant filter with polar symmetry (EQUATIONS 15). Detections are used one by one.
class PolarEquivariantFilter final : public SlamFilter {
 public:
  explicit PolarEquivariantFilter(const FilterSetup& setup)
      : belief_(setup.belief),
        motion_form_(motion_of(setup.options)),
        association_(setup),
        gaussian_(setup.belief) {}

  void start(const Pose& start) override {
    association_.clear();
    motion_.restart();
    gaussian_.start(start);
    report_ = {};
  }
  void predict(const StepContext& /*context*/, const Control& control, double duration) override {
    advance(motion_, control, duration, belief_, motion_form_);
  }
  /// Throws std::runtime_error if the likelihood of the scan is not finite.
  void update(const StepContext& context, Scan scan) override {
    report_ = {};
    gaussian_.move(motion_);
    motion_.restart();
    association_.known() ? association_.pair_by_identity(scan) : pair_nearest(scan);
    report_.association = association_.counts();
    innovations_.start(context, 1, scan.size(), 0.0);
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (association_.pairings()[k].kind != PairingKind::matched || !use(k, scan[k]))
        report_.log_likelihood += association_.unmatched_log_density();
    }
    if (!std::isfinite(report_.log_likelihood))
      throw std::runtime_error("the log-likelihood of the scan is not finite");
    innovations_.add_to(context, report_, components_of(belief_.sensor).size());
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (association_.pairings()[k].kind != PairingKind::fresh || !has_logarithm(scan[k]))
        continue;
      association_.add(scan[k].identity);
      gaussian_.append(vector_of(scan[k]));
    }
    report_.map_size = static_cast<double>(gaussian_.landmarks());
  }

  PoseEstimate estimate() const override { return {gaussian_.pose_after(motion_), std::nullopt}; }
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    for (std::size_t k = 0; k < landmarks.size(); ++k) {
      const std::size_t slot = association_.slot_of(k);
      landmarks[k].reset();
      if (slot < gaussian_.landmarks()) landmarks[k] = gaussian_.landmark(slot);
    }
  }
  std::optional<JointEstimate> joint(std::size_t landmarks) const override {
    return joint_report(gaussian_.joint(), association_, landmarks, [&](std::size_t slot) {
      return slot < gaussian_.landmarks() ? 3 + row_of(slot) : Eigen::Index{-1};
    });
  }

 private:
  /// Noise may make a short range negative, which has no logarithm: such a detection is left out.
  static bool has_logarithm(const Detection& detection) { return detection[0] >= kLeastDistance; }

  void pair_nearest(Scan scan) {
    searches_.assign(scan.size(), {});
    for (std::uint32_t landmark = 0; landmark < gaussian_.landmarks(); ++landmark) {
      const auto expected = gaussian_.expected(landmark);
      if (!expected) {
        ++report_.numerical_faults;
        continue;
      }
      for (std::size_t k = 0; k < scan.size(); ++k) {
        if (!has_logarithm(scan[k])) continue;
        const Eigen::Vector2d innovation = expected->innovation(vector_of(scan[k]));
        const double distance = expected->factor.whiten(innovation).squaredNorm();
        searches_[k].offer(landmark, distance, distance + expected->factor.log_det(),
                           association_.settings().gate);
      }
    }
    association_.pair_nearest(scan, searches_);
  }

  /// Conditions on a matched detection. Returns false if it cannot be used.
  bool use(std::size_t k, const Detection& detection) {
    const std::size_t slot = association_.pairings()[k].landmark;
    const auto expected = gaussian_.expected(slot);
    if (!expected) ++report_.numerical_faults;
    if (!expected || !has_logarithm(detection)) return false;
    const Eigen::Vector2d v = expected->innovation(vector_of(detection));
    const Eigen::Matrix2d S = expected->factor.covariance();
    const auto innovations = innovations_.of_block(0, 1.0);
    innovations.add(k, {{v(0), v(1)}, {S(0, 0), S(1, 0), S(1, 1)}}, AllLanes());
    innovations_.matched_weight(k) = 1.0;
    // The density of a range is that of its logarithm, divided by the range.
    report_.log_likelihood +=
        log_normal_density(expected->factor.whiten(v).squaredNorm(), expected->factor, 2.0) -
        std::log(detection[0]);
    gaussian_.update_with(slot, v, *expected);
    return true;
  }

  Belief belief_;
  Motion motion_form_;
  MapAssociation association_;
  PolarGaussian gaussian_;
  MotionIncrement motion_;  ///< motion since the last scan
  ScanReport report_;
  std::vector<NearestSearch> searches_;     ///< scratch: {detection} searches of a scan
  MixtureInnovations<double> innovations_;  ///< innovations of a mixture of one
};

}  // namespace

FilterKind polar_equivariant_kind() {
  return {.name = "polar_equivariant",
          .long_name = "equivariant filter in polar coordinates",
          .source = "van Goor, Mahony 2023; EQUATIONS 15",
          .reports = {.joint = true},
          .options = {linearised_motion_option()},
          .make = [](const FilterSetup& setup) {
            return std::make_unique<PolarEquivariantFilter>(setup);
          }};
}

}  // namespace montecarta::filters
