// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/pose_evolution.hpp"
#include "filters/fastslam/sigma_filters.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::filters {

/// The use of differential evolution in DE-SRCD-FastSLAM (EQUATIONS 10).
enum class EvolutionMode {
  unbiased,    ///< each particle searches for its best pose; draws are weighted by (6.3)
  as_printed,  ///< the cloud climbs the likelihood and is then refined by the same scan again
  prior,       ///< like as_printed, but the fitness includes the motion and the map's covariance
  shared,      ///< the cloud searches for the centres; draws about them are weighted by (6.3)
};

inline WeightTime weight_time(EvolutionMode mode) {
  return mode == EvolutionMode::unbiased || mode == EvolutionMode::shared ? WeightTime::after_draw
                                                                          : WeightTime::before_draw;
}

struct EvolvedSettings {
  EvolutionMode mode = EvolutionMode::unbiased;
  EvolutionSettings evolution = {.scale = 0.4, .base = EvolutionBase::best};
  EvolutionStart start = EvolutionStart::cloud;
  std::size_t population = 10;  ///< members per particle in mode unbiased, at least 7
  double bounds = 3.0;          ///< bounds of the search, in standard deviations
  double inflation = 1.0;       ///< factor of the covariance of draws that are weighted by (6.3)
};

/// The proposal of SRCD-FastSLAM moved by differential evolution. In modes weighted by the ratio
/// (6.3) of EQUATIONS, the weights are correct for any centre that evolution finds, since the
/// centre depends only on the past and the scan.
template <class Real>
class EvolvedProposal : public RefinedCloud<Real, SigmaPoints, SigmaPoints> {
 public:
  using Cloud = RefinedCloud<Real, SigmaPoints, SigmaPoints>;
  EvolvedProposal(std::size_t particles, const Belief& belief, const EvolvedSettings& settings,
                  const SigmaPoints& points)
      : Cloud(particles, belief, weight_time(settings.mode), points, points),
        settings_(settings),
        particles_(particles),
        centres_(blocks_for<Real>(particles)),
        found_(centres_.size()) {
    if (settings.mode != EvolutionMode::unbiased) return;
    for (std::size_t i = 0; i < particles; i += kLanesOf<Real>)
      own_.emplace_back(std::min(particles - i, kLanesOf<Real>), settings.population);
  }

  /// A pose between prediction and draw.
  struct Refined {
    PoseGaussian<Real> predicted, posterior;
    BasicPose<Real> centre;   ///< mean of the draw
    Evidence<Real> evidence;  ///< evidence of the scan before the draw
    PoseFactor<Real> factor;
  };

  /// Evolves the cloud, in the modes in which it is one population.
  template <class Associating>
  void prepare(const StepContext& context, const Associating& association,
               const Weights<Real>& weights, const std::vector<PoseGaussian<Real>>& predicted) {
    if (settings_.mode == EvolutionMode::unbiased) return;
    for (std::size_t b = 0; b < predicted.size(); ++b) centres_[b] = predicted[b].mean;
    if (association.matches() == 0) return;
    const auto objective = settings_.mode == EvolutionMode::as_printed
                               ? CloudEvolution<Real>::Objective::likelihood
                               : CloudEvolution<Real>::Objective::posterior;
    cloud_.gather(context, association, weights, predicted, this->noise());
    report_.add(cloud_.evolve(objective, settings_.bounds, settings_.start, settings_.evolution,
                              context.identity(Draw::evolution, 0), centres_));
  }

  /// Refines the pose, and in mode unbiased searches for the most probable one near it.
  template <class Associating, class Innovations>
  Refined refine(const StepContext& context, std::size_t b, const PoseGaussian<Real>& predicted,
                 const Associating& association, const Innovations& innovations) {
    PoseGaussian<Real> posterior = predicted;
    if (!has_importance_ratio()) posterior.mean = centres_[b];
    Evidence<Real> evidence;
    this->update_with_scan(association, b, posterior, innovations, evidence);
    this->keep(b, posterior);
    Refined refined{predicted, posterior, posterior.mean, evidence, PoseFactor<Real>(posterior)};
    if (settings_.mode == EvolutionMode::shared) refined.centre = centres_[b];
    if (settings_.mode == EvolutionMode::unbiased) {
      found_[b] = own_[b].most_probable(association, b, predicted, posterior, this->noise(),
                                        settings_.bounds, settings_.evolution,
                                        Cloud::identity(context, Draw::evolution, b));
      const auto [e0, e1, e2] = found_[b].offset;
      refined.centre = refined.factor.at(e0, e1, e2);
    }
    return refined;
  }

  BasicPose<Real> draw(const StepContext& context, std::size_t b, Refined& refined) const {
    PoseFactor<Real> about = refined.factor;
    about.mean = refined.centre;
    const double spread = has_importance_ratio() ? std::sqrt(settings_.inflation) : 1.0;
    return draw_from(about, Cloud::identity(context, Draw::pose_proposal, b), Real(spread));
  }

  /// Updates the landmarks and returns the log of the weight's factor.
  template <class Associating, class Innovations>
  Weighing<Real> update_map(std::size_t b, const BasicPose<Real>& pose,
                            const Associating& association, const Refined& refined,
                            const Innovations& /*innovations*/) const {
    Evidence<Real> drawn;
    this->update_landmarks(association, b, pose, drawn);
    const Real faults = refined.evidence.left_out() + refined.factor.L.faults;
    if (!has_importance_ratio()) return {refined.evidence.log_density(), faults};
    const PoseGaussian<Real> proposal{refined.centre,
                                      settings_.inflation * refined.posterior.covariance};
    const Real ratio =
        PoseDensity<Real>(refined.predicted)(pose) - PoseDensity<Real>(proposal)(pose);
    return {drawn.log_density() + ratio, faults};
  }

  void begin_report() { report_.begin_scan(); }
  std::span<const double> own_columns() const { return report_.values(); }

  void end_scan() {
    Cloud::end_scan();
    // Particles that match nothing have no members, and have not evolved.
    for (std::size_t i = 0; i < particles_ && settings_.mode == EvolutionMode::unbiased; ++i) {
      const MostProbable<Real>& found = found_[i / kLanesOf<Real>];
      if (found.members > 0) report_.add(found.effect(i % kLanesOf<Real>));
    }
    report_.end_scan();
  }

 private:
  bool has_importance_ratio() const {
    return weight_time(settings_.mode) == WeightTime::after_draw;
  }

  EvolvedSettings settings_;
  std::size_t particles_;
  std::vector<BasicPose<Real>> centres_;   ///< {block} poses to which the cloud moved
  std::vector<OwnEvolution<Real>> own_;    ///< {block} evolution of its particles in mode unbiased
  std::vector<MostProbable<Real>> found_;  ///< {block} what own_ found at the last scan
  CloudEvolution<Real> cloud_;
  EvolutionReport report_;
};

/// Reads the options of the evolution.
EvolvedSettings evolved_settings(const FilterOptions& options);

/// DE-SRCD-FastSLAM (Ankishan 2016; EQUATIONS 10): SRCD-FastSLAM with poses moved by differential
/// evolution.
template <class Real>
std::unique_ptr<SlamFilter> make_de_srcd(const FilterSetup& setup) {
  const PopulationSettings settings = population_settings(setup.options);
  return make_fast_slam<Real>(
      setup, settings,
      EvolvedProposal<Real>(settings.particles, setup.belief, evolved_settings(setup.options),
                            central_difference_points(setup, map_uncertainty(setup.options))));
}

FilterKind de_srcd_kind();

}  // namespace montecarta::filters
