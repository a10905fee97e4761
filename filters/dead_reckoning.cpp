// SPDX-License-Identifier: BSD-3-Clause
#include "filters/dead_reckoning.hpp"

#include "filters/moments/motion_increment.hpp"
#include "filters/setup/filter_setup.hpp"

namespace montecarta::filters {
namespace {

/// Integrates the controls and ignores detections: the baseline that every SLAM filter must beat.
class DeadReckoning final : public SlamFilter {
 public:
  explicit DeadReckoning(const FilterSetup& setup) : belief_(setup.belief) {}

  void start(const Pose& start) override {
    start_ = start;
    motion_.restart();
  }
  void predict(const StepContext& /*context*/, const Control& control, double duration) override {
    motion_.advance(control, duration, belief_);
  }
  void update(const StepContext& /*context*/, Scan /*scan*/) override {}

  PoseEstimate estimate() const override {
    const PoseGaussian<double> now = motion_.from(start_);
    return {.spread = {now.mean, symmetric(now.covariance)}, .mixture = std::nullopt};
  }
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    for (auto& landmark : landmarks) landmark.reset();
  }

 private:
  Belief belief_;
  Pose start_;
  MotionIncrement motion_;
  ScanReport report_;
};

}  // namespace

FilterKind dead_reckoning_kind() {
  return {.name = "dead_reckoning",
          .long_name = "dead reckoning",
          .source = "EQUATIONS 1",
          .reports = {.map = false},
          .options = {},
          .sensors = {},
          .make = [](const FilterSetup& setup) { return std::make_unique<DeadReckoning>(setup); }};
}

}  // namespace montecarta::filters
