// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/fast_slam.hpp"

namespace montecarta::filters::plain {

/// FastSLAM I (EQUATIONS 5; Montemerlo et al. 2002): every particle moves with its own noise of the
/// controls, and the scan weighs it.
class FastSlam1 : public FastSlam {
 public:
  using FastSlam::FastSlam;
  PoseEstimate estimate() const override { return {spread_of(particles_), std::nullopt}; }

 private:
  void place_at_start(const Vector<3>& mean, const Matrix<3>& root, RngStream stream,
                      Particle& p) const override {
    p.pose = drawn_from(mean, root, stream);
  }

  /// x ~ f(x, u + e), e ~ N(0, Q), the first half of EQUATIONS (5.1).
  void predict_particle(const StepContext& context, std::uint32_t i, Particle& p,
                        const Control& control, double duration) override {
    const auto sigma = deviations_of(belief_.control, control, belief_.vehicle);
    RngStream draw = context.stream(Draw::motion_sample, i);
    Control u = control;
    for (std::size_t k = 0; k < controls_of(belief_.vehicle).size(); ++k)
      u[k] += sigma[k] * draw.normal();
    auto step = body_step(belief_.vehicle, u, duration);
    if (!belief_.control.increment.is_none()) perturb(context, i, control, duration, step);
    p.pose = to_vector(moved_by(as_pose(p.pose), step));
  }

  /// Adds the noise of the step, whose numbers follow those of the controls (EQUATIONS (1.11),
  /// (1.12)).
  void perturb(const StepContext& context, std::uint32_t i, const Control& control, double duration,
               BodyStep<double>& step) const {
    const IncrementNoise& noise = belief_.control.increment;
    const std::size_t pairs = (controls_of(belief_.vehicle).size() + 1) / 2;
    RngStream draw(context.identity(Draw::motion_sample, i), static_cast<std::uint32_t>(pairs));
    std::array<double, 3> e{};
    for (double& one : e) one = draw.normal();
    const auto given = body_step(belief_.vehicle, control, duration);
    step = perturbed(step, noise.model, increment_deviations(noise, given, duration), e);
  }

  /// Adds sum_k log N(z_k - h(x, mu_k); Hf Sigma_k Hf' + R), the second half of EQUATIONS (5.1).
  void weigh_and_draw(const StepContext& /*context*/, std::uint32_t /*i*/, Particle& p,
                      Scan scan) override {
    for_each_match(p, scan, [&](const Landmark& landmark, std::size_t k) {
      p.log_weight += counted(k, innovation(p.pose, landmark, scan[k]));
    });
  }
};

}  // namespace montecarta::filters::plain
