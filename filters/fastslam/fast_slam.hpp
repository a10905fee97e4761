// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/particles/block_tasks.hpp"
#include "filters/fastslam/particle_maps.hpp"
#include "filters/population/cloud_moments.hpp"
#include "filters/population/population.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace montecarta {

/// Rao-Blackwellised particle filter with one map per particle (SPEC 5). `Real`: double or Lanes.
/// `Proposal` moves, weighs and draws poses and updates the maps of one block; `Associating`
/// decides which landmark a detection is. Between update() and the next predict() the particles are
/// weighed and drawn but not yet resampled: that is the state that is estimated and recorded.
template <class Real, class Proposal, class Associating>
class FastSlam final : public SlamFilter {
 public:
  FastSlam(const PopulationSettings& settings, Proposal proposal, Associating association)
      : proposal_(std::move(proposal)),
        association_(std::move(association)),
        population_(settings),
        poses_(population_.blocks()),
        resampled_poses_(poses_.size()),
        maps_(settings.particles) {}

  void start(const Pose& start) override {
    population_.start();
    maps_.clear();
    association_.clear();
    std::fill(poses_.begin(), poses_.end(), BasicPose<Real>{start.x, start.y, start.heading});
    proposal_.start(poses_);
  }

  void predict(const StepContext& context, const Control& control, double duration) override {
    settle();
    proposal_.predict(context, control, duration, weights(), poses_);
  }

  void update(const StepContext& context, Scan scan) override {
    settle();
    proposal_.begin_scan(context, poses_);
    association_.associate(
        context, scan, maps_, [&](std::size_t b) { return proposal_.predicted(b, poses_[b]); },
        [&](auto&&... sight) { return proposal_.expected(sight...); });
    population_.begin_scan();
    const bool blind = association_.found_nothing();
    if (!blind) weigh_and_draw(context);
    population_.report().association = association_.counts(weights());
    if (!blind) add_new_landmarks();
    population_.report().map_size = association_.map_size(maps_, weights());
    if (!blind) population_.decide_on_resampling(context);
  }

  PoseEstimate estimate() const override { return proposal_.estimate(weights(), poses_); }
  const ScanReport& report() const override { return population_.report(); }
  void particles(const ParticleColumns& columns) const override;
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override;

 private:
  const Weights<Real>& weights() const { return population_.weights(); }

  void weigh_and_draw(const StepContext& context) {
    const BlockTasks<Real> tasks(poses_.size());
    innovations_.start(tasks.count(), association_.matches());
    for (std::size_t k = 0; k < association_.matches(); ++k) {
      innovations_.matched_weight(k) = association_.matched_weight(k, weights());
    }
    proposal_.prepare(context, association_, weights(), poses_, maps_);
    tasks.run(context,
              [&](std::size_t task, std::size_t b) { weigh_and_draw_block(context, task, b); });
    population_.normalise();
    innovations_.add_to(population_.report());
    proposal_.end_scan();
  }

  void weigh_and_draw_block(const StepContext& context, std::size_t task, std::size_t b) {
    const auto innovations = innovations_.of_block(task, weights().linear()[b]);
    const auto note = [&](std::size_t k, const Innovation<Real>& innovation, const auto& matched) {
      innovations.add(k, innovation, matched);
    };
    const Weighing<Real> weighing =
        proposal_.weigh_and_draw(context, association_, b, poses_[b], note);
    population_.weigh(
        b, {weighing.log_weight + association_.unmatched_log_weight(b), weighing.faults});
  }

  void add_new_landmarks() {
    association_.add_new(
        maps_,
        [&](std::size_t b, const RangeBearing<Real>& seen) {
          return proposal_.birth(b, poses_[b], seen);
        },
        [&](std::size_t b, std::uint32_t slot, const auto& put) {
          proposal_.settled(maps_, b, slot, put);
        });
  }

  std::optional<LandmarkEstimate> landmark(std::size_t j) const;

  /// Ends the time in which the particles of the last scan can be asked for: resampling takes
  /// effect.
  void settle() {
    if (!population_.is_after_scan()) return;
    if (population_.resample()) {
      const std::span<const std::uint32_t> parents = population_.ancestors();
      gather<Real>(poses_, parents, resampled_poses_);
      std::swap(poses_, resampled_poses_);
      maps_.resample(parents);
      association_.resample(parents);
      proposal_.resample(parents);
    }
    proposal_.settle();
  }

  Proposal proposal_;
  Associating association_;
  Population<Real> population_;
  std::vector<BasicPose<Real>> poses_, resampled_poses_;
  ParticleMaps<Real> maps_;
  MixtureInnovations<Real> innovations_;
  mutable std::vector<std::uint32_t> slot_source_;           ///< scratch of map()
  mutable std::vector<LandmarkGaussian<Real>> slot_blocks_;  ///< scratch of map()
};

}  // namespace montecarta

#include "filters/fastslam/fast_slam_reports.hpp"
