// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/particles/resampling.hpp"
#include "engine/particles/weights.hpp"
#include "filters/joint/joint_belief.hpp"
#include "filters/moments/innovation_sums.hpp"

#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace montecarta {

/// How the noise of a control reaches the pose.
enum class Motion {
  linearised,  ///< EQUATIONS 1
  quadrature,  ///< moved_by_quadrature()
};

/// What a bank of joint Gaussians can be told.
struct BankSettings {
  std::size_t particles = 1;  ///< components
  Retraction retraction = Retraction::additive;
  Resampling resampling = Resampling::systematic;
  double resample_below = 0.5;  ///< resample where ESS < this times particles (EQUATIONS 18)
  /// [rad] a component that knows its heading worse than this after a scan draws it; nothing: where
  /// the second-order error that it makes over the extent D of the map, sigma^2 D / 2, exceeds
  /// sigma_range
  std::optional<double> split_beyond = std::numeric_limits<double>::infinity();
  double keep = 0.0;   ///< share of the heading's standard deviation that a draw leaves
  int iterations = 0;  ///< of the linearisation, after the first
  Motion motion = Motion::linearised;
  bool tells_particles = false;  ///< whether there is a mixture to tell of
};

/// A mixture of joint Gaussians over pose and map (EQUATIONS 16). Only the heading is ever drawn,
/// by a split of the Gaussian, and only where it is uncertain: what a component does not draw it
/// keeps in its covariance. One component that never splits is EKF-SLAM.
///
/// Particles that are copies of each other share one belief until they are split; so a bank costs
/// what its distinct beliefs cost.
class GaussianBank final : public SlamFilter {
 public:
  GaussianBank(const FilterSetup& setup, const BankSettings& settings);

  void start(const Pose& start) override;
  void predict(const StepContext& context, const Control& control, double duration) override;
  void update(const StepContext& context, Scan scan) override;
  PoseEstimate estimate() const override;
  const ScanReport& report() const override { return report_; }
  void particles(const ParticleColumns& columns) const override;
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override;
  std::optional<JointEstimate> joint(std::size_t landmarks) const override;

 private:
  const JointBelief& belief_of(std::size_t particle) const { return beliefs_[slot_of_[particle]]; }
  void settle();
  void weigh();
  PoseEstimate mixture() const;
  void report_innovations(Scan scan);
  bool is_due(const JointBelief& belief) const;
  void deal_strata(const StepContext& context);
  void split(const StepContext& context);
  void part_those_due();
  void note_active();
  void decide_on_resampling(const StepContext& context);
  void weigh_beliefs() const;
  template <class Visit>
  void for_beliefs(const Visit& visit) const;
  std::optional<LandmarkEstimate> landmark(std::size_t k) const;

  Belief belief_;
  BankSettings settings_;
  bool known_;
  Weights<double> weights_;
  std::vector<JointBelief> beliefs_;          ///< those of no particle are idle
  std::vector<std::uint32_t> slot_of_;        ///< {particle} its belief
  std::vector<std::uint32_t> active_;         ///< the beliefs that some particle has, in order
  mutable std::vector<double> slot_weights_;  ///< scratch of mixture(), map() and joint()
  std::vector<std::uint32_t> parents_;  ///< of the resampling that is decided but not yet in effect
  std::vector<std::uint32_t> ancestors_;     ///< one scan ago
  std::vector<double> weights_before_scan_;  ///< {particle}
  std::vector<double> matched_weights_;      ///< {detection} of the particles that know it
  std::vector<std::uint32_t> idle_;          ///< scratch
  std::vector<char> taken_;                  ///< scratch: {belief} whether a particle keeps it
  std::vector<char> is_due_;                 ///< scratch: {belief} whether it is to be split
  std::vector<std::pair<double, std::uint32_t>> strata_;  ///< scratch: particles in random order
  mutable std::vector<PoseMoments> poses_;                ///< scratch: {belief}
  MotionIncrement motion_;  ///< since the beliefs last moved, the same for all of them
  InnovationSums<double> innovations_;
  PoseEstimate estimate_of_scan_;  ///< before headings were drawn
  ScanReport report_;
  bool after_update_ = false;
};

}  // namespace montecarta
