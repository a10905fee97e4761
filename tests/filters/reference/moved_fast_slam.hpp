// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/reference/fast_slam2.hpp"

#include <deque>
#include <utility>
#include <vector>

namespace montecarta::reference {

/// FastSLAM II whose particles, after a resampling, live their last `lag` scans once more, step by
/// step, and take the new past with probability min(1, w'/w).
class MovedFastSlam2 final : public FastSlam2 {
 public:
  MovedFastSlam2(const FastSlamSettings& settings, Weight weight, std::size_t lag)
      : FastSlam2(settings, weight), lag_(lag) {}

 private:
  struct Step {
    std::vector<std::pair<Control, double>> controls;
    std::vector<Detection> scan;
  };

  RngStream pose_numbers(const StepContext& context, std::uint32_t i) const override {
    if (turn_ < 0) return FastSlam2::pose_numbers(context, i);
    return RngStream(context.identity(Draw::pose_move, i), 2 * static_cast<std::uint32_t>(turn_));
  }
  void note_control(const Control& control, double duration) override {
    now_.controls.emplace_back(control, duration);
    if (std::exchange(is_noted_, true)) return;
    for (Particle& p : particles_) p.past.push_back(without_past(p));
  }
  void note_scan(Scan scan) override {
    now_.scan.assign(scan.begin(), scan.end());
    before_.clear();
    for (const Particle& p : particles_) before_.push_back(p.log_weight);
  }
  void end_scan() override {
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      Particle& p = particles_[i];
      p.past_log_weights.push_back(p.log_weight + report().log_likelihood - before_[i]);
      if (steps_.size() < lag_) continue;
      p.past.erase(p.past.begin());
      p.past_log_weights.erase(p.past_log_weights.begin());
    }
    if (steps_.size() == lag_) steps_.pop_front();
    steps_.push_back(std::exchange(now_, {}));
    is_noted_ = false;
  }

  void part(const StepContext& context) override {
    for (std::uint32_t i = 0; i < particles_.size(); ++i) {
      Particle& p = particles_[i];
      Particle again = p.past.front();
      std::vector<Particle> past;
      std::vector<double> log_weights;
      double log_ratio = 0.0;
      for (std::size_t k = 0; k < steps_.size(); ++k) {
        past.push_back(again);
        again.log_weight = 0.0;
        turn_ = static_cast<int>(k);
        live(context, i, again, steps_[k]);
        log_weights.push_back(again.log_weight);
        log_ratio += again.log_weight - p.past_log_weights[k];
      }
      turn_ = -1;
      if (std::log(context.stream(Draw::move_acceptance, i).uniform()) >= log_ratio) continue;
      again.log_weight = p.log_weight;
      again.ancestor = p.ancestor;
      again.past = std::move(past);
      again.past_log_weights = std::move(log_weights);
      p = std::move(again);
      ++taken;
    }
  }
  void live(const StepContext& context, std::uint32_t i, Particle& p, const Step& step) {
    for (const auto& [control, duration] : step.controls) {
      predict_particle(context, i, p, control, duration);
    }
    associate(p, step.scan);
    weigh_and_draw(context, i, p, step.scan);
    update_maps(p, step.scan);
    add_new_landmarks(p, step.scan);
  }
  static Particle without_past(const Particle& p) {
    Particle copy = p;
    copy.past.clear(), copy.past_log_weights.clear();
    return copy;
  }

  std::size_t lag_;
  Step now_;
  std::deque<Step> steps_;
  std::vector<double> before_;
  bool is_noted_ = false;
  int turn_ = -1;

 public:
  int taken = 0;  ///< moves, for tests to know that there were any
};

}  // namespace montecarta::reference
