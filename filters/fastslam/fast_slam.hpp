// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/particles/block_tasks.hpp"
#include "engine/particles/resampling.hpp"
#include "engine/particles/weights.hpp"
#include "filters/fastslam/fast_slam_options.hpp"
#include "filters/fastslam/particle_maps.hpp"
#include "filters/moments/cloud_moments.hpp"
#include "filters/moments/evidence.hpp"
#include "filters/moments/innovation_sums.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace montecarta {

/// Rao-Blackwellised particle filter with one map per particle (EQUATIONS 4). `Real`: double or
/// Lanes. `Proposal` moves, weighs and draws poses and updates the maps of one block; `Associating`
/// decides which landmark a detection is. Between update() and the next predict() the particles are
/// weighed and drawn but not yet resampled: that is the state that is estimated and recorded.
template <class Real, class Proposal, class Associating>
class FastSlam final : public SlamFilter {
 public:
  FastSlam(const FastSlamSettings& settings, Proposal proposal, Associating association)
      : settings_(settings),
        proposal_(std::move(proposal)),
        association_(std::move(association)),
        weights_(settings.particles),
        poses_(blocks_for<Real>(settings.particles)),
        resampled_poses_(poses_.size()),
        maps_(settings.particles),
        parents_(poses_.size() * kLanesOf<Real>),
        ancestors_(parents_.size()),
        faults_(poses_.size()) {}

  void start(const Pose& start) override {
    weights_.make_equal();
    maps_.clear();
    association_.clear();
    std::fill(poses_.begin(), poses_.end(), BasicPose<Real>{start.x, start.y, start.heading});
    std::iota(ancestors_.begin(), ancestors_.end(), 0U);
    proposal_.start(poses_);
    report_ = {};
    after_update_ = false;
  }

  void predict(const StepContext& context, const Control& control, double duration) override {
    settle();
    proposal_.predict(context, control, duration, weights_, poses_);
  }

  void update(const StepContext& context, Scan scan) override {
    settle();
    after_update_ = true;
    proposal_.begin_scan(context, poses_);
    association_.associate(
        context, scan, maps_, [&](std::size_t b) { return proposal_.predicted(b, poses_[b]); },
        [&](auto&&... sight) { return proposal_.expected(sight...); });
    report_ = {.ess = weights_.effective()};
    const bool blind = association_.found_nothing();
    if (!blind) weigh_and_draw(context);
    report_.association = association_.counts(weights_);
    if (!blind) add_new_landmarks();
    report_.map_size = association_.map_size(maps_, weights_);
    if (!blind) decide_on_resampling(context);
  }

  PoseEstimate estimate() const override { return proposal_.estimate(weights_, poses_); }
  const ScanReport& report() const override { return report_; }
  void particles(const ParticleColumns& columns) const override;
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override;

 private:
  void weigh_and_draw(const StepContext& context) {
    const BlockTasks<Real> tasks(poses_.size());
    innovations_.start(tasks.count(), association_.matches());
    matched_weights_.resize(association_.matches());
    for (std::size_t k = 0; k < matched_weights_.size(); ++k) {
      matched_weights_[k] = association_.matched_weight(k, weights_);
    }
    proposal_.prepare(context, association_, weights_, poses_, maps_);
    tasks.run(context,
              [&](std::size_t task, std::size_t b) { weigh_and_draw_block(context, task, b); });
    report_.log_likelihood = weights_.normalise();
    report_.ess = weights_.effective();
    for (std::size_t i = 0; i < settings_.particles; ++i) {
      report_.numerical_faults += static_cast<std::uint32_t>(scalars(faults_)[i]);
    }
    proposal_.end_scan();
  }

  void weigh_and_draw_block(const StepContext& context, std::size_t task, std::size_t b) {
    const Real weight = weights_.linear()[b];
    const auto note = [&](std::size_t k, const Innovation<Real>& innovation, const auto& matched) {
      innovations_.add(task, k, innovation, weight * as_number<Real>(matched));
    };
    const Weighing<Real> weighing =
        proposal_.weigh_and_draw(context, association_, b, poses_[b], note);
    weights_.multiply(b, weighing.log_weight + association_.unmatched_log_weight(b));
    faults_[b] = weighing.faults;
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

  void decide_on_resampling(const StepContext& context) {
    report_innovations();
    report_.resampled =
        report_.ess < settings_.resample_below * static_cast<double>(settings_.particles);
    if (!report_.resampled) return;
    draw_parents(settings_.resampling, weights_.linear_scalars(), context,
                 std::span(parents_).first(settings_.particles));
    std::fill(parents_.begin() + static_cast<std::ptrdiff_t>(settings_.particles), parents_.end(),
              0U);
  }

  void report_innovations();
  std::optional<LandmarkEstimate> landmark(std::size_t j) const;

  /// Ends the time in which the particles of the last scan can be asked for: resampling takes
  /// effect.
  void settle() {
    if (!std::exchange(after_update_, false)) return;
    if (report_.resampled) {
      gather<Real>(poses_, parents_, resampled_poses_);
      std::swap(poses_, resampled_poses_);
      maps_.resample(parents_);
      association_.resample(parents_);
      proposal_.resample(parents_);
      weights_.make_equal();
      ancestors_ = parents_;
    } else {
      std::iota(ancestors_.begin(), ancestors_.end(), 0U);
    }
    proposal_.settle();
  }

  FastSlamSettings settings_;
  Proposal proposal_;
  Associating association_;
  Weights<Real> weights_;
  std::vector<BasicPose<Real>> poses_, resampled_poses_;
  ParticleMaps<Real> maps_;
  InnovationSums<Real> innovations_;
  std::vector<double> matched_weights_;  ///< of each detection, before the scan
  std::vector<std::uint32_t> parents_;  ///< of the resampling that is decided but not yet in effect
  std::vector<std::uint32_t> ancestors_;            ///< one scan ago
  std::vector<Real> faults_;                        ///< of each block's particles in this scan
  mutable std::vector<std::uint32_t> slot_source_;  ///< scratch of map()
  mutable std::vector<LandmarkGaussian<Real>> slot_blocks_;  ///< scratch of map()
  ScanReport report_;
  bool after_update_ = false;
};

}  // namespace montecarta

#include "filters/fastslam/fast_slam_reports.hpp"
