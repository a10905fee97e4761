// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/joint/joint_belief.hpp"
#include "filters/moments/control_motion.hpp"
#include "filters/population/population.hpp"

#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// What a bank of joint Gaussians can be told.
struct BankSettings {
  PopulationSettings population = {.particles = 1};  ///< components
  Retraction retraction = Retraction::additive;
  /// [rad] a component that knows its heading worse than this after a scan draws it; nothing: where
  /// the second-order error that it makes over the extent D of the map, sigma^2 D / 2, exceeds
  /// the noise of a detection [m]
  std::optional<double> split_beyond = std::numeric_limits<double>::infinity();
  double keep = 0.0;   ///< share of the heading's standard deviation that a draw leaves
  int iterations = 0;  ///< of the linearisation, after the first
  Motion motion = Motion::linearised;
  Moments moments = Moments::map;  ///< of what it reports
  Linearisation linearisation = Linearisation::estimate;
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
  const ScanReport& report() const override { return population_.report(); }
  void particles(const ParticleColumns& columns) const override;
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override;
  std::optional<JointEstimate> joint(std::size_t landmarks) const override;

 private:
  const JointBelief& belief_of(std::size_t particle) const { return beliefs_[slot_of_[particle]]; }
  double weight_of(std::size_t particle) const { return population_.weights().linear()[particle]; }
  void settle();
  void weigh();
  PoseEstimate mixture() const;
  void gather_innovations(Scan scan);
  void find_advancing(const StepContext& context, Scan scan);
  bool is_due(const JointBelief& belief) const;
  void deal_strata(const StepContext& context);
  void split(const StepContext& context);
  void part_those_due();
  void note_active();
  void weigh_beliefs() const;
  template <class Visit>
  void for_beliefs(const Visit& visit) const;
  std::optional<LandmarkEstimate> landmark(std::size_t k) const;

  Belief belief_;
  BankSettings settings_;
  bool known_;
  Population<double> population_;
  std::vector<JointBelief> beliefs_;          ///< those of no particle are idle
  std::vector<std::uint32_t> slot_of_;        ///< {particle} its belief
  std::vector<std::uint32_t> old_slot_of_;    ///< scratch of settle()
  std::vector<std::uint32_t> active_;         ///< the beliefs that some particle has, in order
  mutable std::vector<double> slot_weights_;  ///< scratch of mixture(), map() and joint()
  std::vector<std::span<const char>> found_;  ///< scratch: {active, detection} may advance
  std::vector<char> advancing_;               ///< scratch: {detection} in all beliefs
  std::vector<std::uint32_t> idle_;           ///< scratch
  std::vector<char> taken_;                   ///< scratch: {belief} whether a particle keeps it
  std::vector<char> is_due_;                  ///< scratch: {belief} whether it is to be split
  std::vector<std::pair<double, std::uint32_t>> strata_;  ///< scratch: particles in random order
  mutable std::vector<PoseMoments> poses_;                ///< scratch: {belief}
  MotionIncrement motion_;  ///< since the beliefs last moved, the same for all of them
  MixtureInnovations<double> innovations_;
  PoseEstimate estimate_of_scan_;  ///< before headings were drawn
};

}  // namespace montecarta::filters
