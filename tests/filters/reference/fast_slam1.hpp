// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/fast_slam.hpp"

namespace montecarta::filters::reference {

/// FastSLAM I (EQUATIONS 5): poses are drawn from the motion model at every step, and weighed by
/// the scan.
class FastSlam1 : public FastSlam {
 public:
  using FastSlam::FastSlam;
  PoseEstimate estimate() const override { return {drawn(), std::nullopt}; }

 private:
  void predict_particle(const StepContext& context, std::uint32_t i, Particle& p,
                        const Control& control, double duration) override {
    const Belief& belief = settings_.belief;
    RngStream draw = context.stream(Draw::motion_sample, i);
    const double speed = control[0] + belief.control.sigma[0] * draw.normal();
    const double steer = control[1] + belief.control.sigma[1] * draw.normal();
    const Pose moved = move(as_pose(p.pose), Control{speed, steer}, duration, belief.vehicle);
    p.pose = Eigen::Vector3d(moved.x, moved.y, moved.heading);
  }

  void weigh_and_draw(const StepContext&, std::uint32_t, Particle& p, Scan scan) override {
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (p.pairings[k].kind != PairingKind::matched) continue;
      const auto seen = seen_from(p.pose, *p.map[p.pairings[k].landmark], scan[k], R_);
      if (seen) p.log_weight += log_gaussian<2>(seen->nu, seen->S_f);
    }
  }
};

}  // namespace montecarta::filters::reference
