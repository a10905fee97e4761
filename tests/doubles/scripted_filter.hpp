// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace montecarta::engine {

/// A fault of a scripted filter at one step, in one run or in every run.
struct Mishap {
  enum class Kind { throws, pose_is_nan, covariance_is_infinite };
  Kind kind = Kind::throws;
  std::optional<std::uint64_t> run{};  ///< nullopt: every run
  std::uint32_t step = 17;
};

/// A filter that estimates nothing: its particles wander by its own random streams, so that every
/// column has something to say and each bit depends on (seed, run, step, particle) and on the drive
/// it was given.
class ScriptedFilter : public SlamFilter {
 public:
  struct Script {
    std::size_t particles = 4;
    std::size_t landmarks = 3;
    std::optional<Mishap> mishap{};
    std::chrono::microseconds pace{0};  ///< pause at every step
    std::size_t own_values = 0;         ///< number of values in ScanReport::own
    bool has_mixture = true;
  };

  explicit ScriptedFilter(Script script)
      : script_(script), particles_(script.particles), own_(script.own_values) {}

  void start(const Pose& start) override {
    std::ranges::fill(particles_, start);
    report_ = {};
    seen_ = 0;
    broken_ = false;
  }

  void predict(const StepContext& context, const Control& control, double duration) override {
    if (script_.pace.count() > 0) std::this_thread::sleep_for(script_.pace);
    context.parallel_for(particles_.size(), [&](std::size_t i) {
      RngStream draw = context.stream(Draw::motion_sample, static_cast<std::uint32_t>(i));
      Pose& pose = particles_[i];
      pose.heading = wrap(pose.heading + duration * (control[1] + 0.01 * draw.normal()));
      pose.x += duration * control[0] * std::cos(pose.heading);
      pose.y += duration * control[0] * std::sin(pose.heading) + 0.01 * draw.normal();
    });
    meet_mishap(context);
  }

  void update(const StepContext& context, Scan scan) override {
    RngStream draw = context.stream(Draw::resampling, 0);
    report_.ess = static_cast<double>(particles_.size()) * draw.uniform();
    report_.resampled = draw.uniform() < 0.5;
    report_.log_likelihood = draw.normal();
    report_.nis = 0.0;
    for (const Detection& detection : scan) report_.nis += detection[0];
    report_.nis_dof = static_cast<std::uint32_t>(2 * scan.size());
    report_.association = {.correct = static_cast<double>(scan.size()), .missed = 1.0};
    seen_ = std::min(script_.landmarks, seen_ + scan.size());
    for (std::size_t k = 0; k < own_.size(); ++k) own_[k] = static_cast<double>(scan.size() + k);
    report_.own = own_;
  }

  PoseEstimate estimate() const override {
    PoseEstimate estimate;
    for (const Pose& pose : particles_) {
      estimate.spread.mean.x += pose.x / static_cast<double>(particles_.size());
      estimate.spread.mean.y += pose.y / static_cast<double>(particles_.size());
    }
    estimate.spread.mean.heading = particles_.front().heading;
    estimate.spread.covariance = Eigen::Matrix3d::Identity();
    if (broken_) break_estimate(estimate.spread);
    if (script_.has_mixture) estimate.mixture = estimate.spread;
    return estimate;
  }

  const ScanReport& report() const override { return report_; }

  void particles(const ParticleColumns& columns) const override {
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      if (!columns.pose.empty()) {
        columns.pose[3 * i] = particles_[i].x;
        columns.pose[3 * i + 1] = particles_[i].y;
        columns.pose[3 * i + 2] = particles_[i].heading;
      }
      if (!columns.log_weight.empty())
        columns.log_weight[i] = -std::log(static_cast<double>(particles_.size()));
      if (!columns.ancestor.empty())
        columns.ancestor[i] = static_cast<std::uint32_t>(report_.resampled ? i / 2 : i);
    }
  }

  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    for (std::size_t l = 0; l < std::min(seen_, landmarks.size()); ++l)
      landmarks[l] = {{particles_.front().x, static_cast<double>(l)}, Eigen::Matrix2d::Identity()};
  }

  /// A covariance that says which element it is, on the way to which one factorisation failed.
  std::optional<JointEstimate> joint(std::size_t landmarks) const override {
    const auto size = static_cast<Eigen::Index>(3 + 2 * landmarks);
    JointEstimate joint{Eigen::VectorXd::LinSpaced(size, 0.0, static_cast<double>(size - 1)),
                        Eigen::MatrixXd::Identity(size, size)};
    joint.mean(0) = static_cast<double>(seen_);
    joint.covariance(size - 1, 0) = joint.covariance(0, size - 1) = 0.5;
    joint.numerical_faults = 1;
    return joint;
  }

 private:
  void meet_mishap(const StepContext& context) {
    const auto& mishap = script_.mishap;
    if (!mishap || context.step() != mishap->step) return;
    if (mishap->run && *mishap->run != context.run()) return;
    if (mishap->kind == Mishap::Kind::throws)
      throw std::runtime_error("scripted mishap of run " + std::to_string(context.run()));
    broken_ = true;
  }

  void break_estimate(PoseMoments& moments) const {
    if (script_.mishap->kind == Mishap::Kind::pose_is_nan)
      moments.mean.y = std::numeric_limits<double>::quiet_NaN();
    else
      moments.covariance(1, 1) = std::numeric_limits<double>::infinity();
  }

  Script script_;
  std::vector<Pose> particles_;
  std::vector<double> own_;
  ScanReport report_;
  std::size_t seen_ = 0;
  bool broken_ = false;
};

}  // namespace montecarta::engine
