// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/resampling.hpp"
#include "engine/particles/weights.hpp"
#include "filters/moments/evidence.hpp"
#include "filters/population/innovation_sums.hpp"
#include "filters/setup/filter_setup.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// How many particles there are, and how and when they are resampled (EQUATIONS 18).
struct PopulationSettings {
  std::size_t particles = 100;
  Resampling resampling = Resampling::systematic;
  double resample_below = 0.5;  ///< resample where ESS < this times particles
};

/// The options `particles`, `resampling`, `resample_below`, in the order in which they are
/// documented.
std::vector<Option> population_options();
/// Reads them.
PopulationSettings population_settings(const FilterOptions& options);

/// What all filters with particles have in common, whatever a particle is: weights, descent,
/// resampling, and the report of a scan. Between a scan and the next step the particles are weighed
/// but not yet resampled by that scan's weights: that is the state that is estimated and recorded.
template <class Real>
class Population {
 public:
  explicit Population(const PopulationSettings& settings)
      : settings_(settings),
        weights_(settings.particles),
        parents_(blocks() * kLanesOf<Real>),
        ancestors_(parents_.size()),
        faults_(blocks(), Real(0.0)) {}

  std::size_t particles() const { return settings_.particles; }
  std::size_t blocks() const { return blocks_for<Real>(settings_.particles); }
  Weights<Real>& weights() { return weights_; }
  const Weights<Real>& weights() const { return weights_; }
  ScanReport& report() { return report_; }
  const ScanReport& report() const { return report_; }
  /// Of particle i: one scan ago.
  std::span<const std::uint32_t> ancestors() const { return ancestors_; }

  void start() {
    weights_.make_equal();
    forget_ancestors();
    report_ = {};
    is_after_scan_ = false;
  }
  void begin_scan() {
    is_after_scan_ = true;
    report_ = {.ess = weights_.effective()};
  }
  bool is_after_scan() const { return is_after_scan_; }

  void weigh(std::size_t block, const Weighing<Real>& weighing) {
    weights_.multiply(block, weighing.log_weight);
    faults_[block] = weighing.faults;
  }
  /// After every block was weighed.
  void normalise() {
    report_.log_likelihood = weights_.normalise();
    report_.ess = weights_.effective();
    for (const double faults : scalars(faults_).first(settings_.particles))
      report_.numerical_faults += static_cast<std::uint32_t>(faults);
  }

  /// Draws the parents of the particles to come, where the weights have degenerated.
  void decide_on_resampling(const StepContext& context) {
    report_.resampled =
        weights_.effective() < settings_.resample_below * static_cast<double>(settings_.particles);
    if (!report_.resampled) return;
    draw_parents(settings_.resampling, weights_.linear_scalars(), context,
                 std::span(parents_).first(settings_.particles));
    std::fill(parents_.begin() + static_cast<std::ptrdiff_t>(settings_.particles), parents_.end(),
              0U);
  }
  /// Resampling takes effect before the next step: true where it gave ancestors().
  bool resample() {
    if (!std::exchange(is_after_scan_, false)) return false;
    if (!report_.resampled) {
      forget_ancestors();
      return false;
    }
    ancestors_ = parents_;
    weights_.make_equal();
    return true;
  }

  /// Draws the ancestors at once, by weights of the caller's (EQUATIONS 12): of marginal filters,
  /// which resample before they weigh.
  void draw_ancestors(const StepContext& context, std::span<const double> weights) {
    report_.resampled = true;
    draw_parents(settings_.resampling, weights, context,
                 std::span(ancestors_).first(settings_.particles));
  }
  /// Every particle is its own ancestor.
  void forget_ancestors() { std::iota(ancestors_.begin(), ancestors_.end(), 0U); }

  /// Writes what was asked for of the particles, the pose of each as `pose_of(i)`.
  template <class PoseOf>
  void tell(const ParticleColumns& columns, const PoseOf& pose_of) const {
    for (std::size_t i = 0; i < columns.pose.size() / 3; ++i) {
      const Pose pose = pose_of(i);
      columns.pose[3 * i] = pose.x;
      columns.pose[3 * i + 1] = pose.y;
      columns.pose[3 * i + 2] = pose.heading;
    }
    std::copy_n(weights_.log_scalars().begin(), columns.log_weight.size(),
                columns.log_weight.begin());
    std::copy_n(ancestors_.begin(), columns.ancestor.size(), columns.ancestor.begin());
  }

 private:
  PopulationSettings settings_;
  Weights<Real> weights_;
  std::vector<std::uint32_t> parents_;  ///< of the resampling that is decided but not yet in effect
  std::vector<std::uint32_t> ancestors_;
  std::vector<Real> faults_;  ///< of each block's particles in this scan
  ScanReport report_;
  bool is_after_scan_ = false;
};

}  // namespace montecarta::filters
