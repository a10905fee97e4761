// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/cloud_evolution.hpp"
#include "filters/fastslam/own_evolution.hpp"
#include "filters/fastslam/refined_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta {

/// What differential evolution is used for in DE-SRCD-FastSLAM (SPEC 13).
enum class EvolutionMode {
  honest,      ///< each particle seeks its most probable pose, draws about it and pays for the draw
  as_printed,  ///< the cloud climbs the likelihood and is then refined by the same scan once more
  prior,       ///< the same with the motion and the map's covariance in the fitness
  shared,      ///< the cloud seeks the centres, and every particle pays for its draw
};

struct EvolvedSettings {
  EvolutionMode mode = EvolutionMode::honest;
  EvolutionSettings evolution = {.scale = 0.4, .base = EvolutionBase::best};
  std::size_t population = 10;  ///< of each particle in mode honest, at least 7
  double bounds = 3.0;          ///< of the search, in standard deviations
  double inflation = 1.0;       ///< of the covariance that is drawn from where the draw is paid for
};

/// The proposal of SRCD-FastSLAM moved by differential evolution. Where the draw is paid for by the
/// ratio of SPEC 7.2 r, the weights are right whatever centre evolution found, since it knows
/// nothing but the past and the scan.
template <class Real>
class EvolvedProposal : public RefinedCloud<Real, SigmaPoints, SigmaPoints> {
 public:
  using Cloud = RefinedCloud<Real, SigmaPoints, SigmaPoints>;
  EvolvedProposal(std::size_t particles, const Belief& belief, const EvolvedSettings& settings,
                  const SigmaPoints& points)
      : Cloud(particles, belief, points, points),
        settings_(settings),
        predicted_(blocks_for<Real>(particles)),
        centres_(predicted_.size()) {
    if (settings.mode != EvolutionMode::honest) return;
    for (std::size_t i = 0; i < particles; i += kLanesOf<Real>)
      own_.emplace_back(std::min(particles - i, kLanesOf<Real>), settings.population);
  }

  /// Moves the cloud, in the modes in which it is one population.
  template <class Matches, class Maps>
  void prepare(const StepContext& context, const Matches& matches, const Weights<Real>& weights,
               const std::vector<BasicPose<Real>>& poses, Maps& /*maps*/) {
    if (settings_.mode == EvolutionMode::honest) return;
    for (std::size_t b = 0; b < poses.size(); ++b) {
      predicted_[b] = this->predicted(b, poses[b]);
      centres_[b] = predicted_[b].mean;
    }
    if (matches.matches() == 0) return;
    const auto aim = settings_.mode == EvolutionMode::as_printed
                         ? CloudEvolution<Real>::Aim::likelihood
                         : CloudEvolution<Real>::Aim::posterior;
    cloud_.gather(matches, weights, predicted_, this->noise());
    cloud_.evolve(aim, settings_.bounds, settings_.evolution, context.identity(Draw::evolution, 0),
                  centres_);
  }

  /// Refines, evolves, draws and weighs one block and updates its landmarks.
  template <class Matches, class Note>
  Weighing<Real> weigh_and_draw(const StepContext& context, const Matches& matches, std::size_t b,
                                BasicPose<Real>& pose, const Note& note) {
    const PoseGaussian<Real> prior = this->predicted(b, pose);
    PoseGaussian<Real> posterior = prior;
    if (!pays_for_draw()) posterior.mean = centres_[b];
    Evidence<Real> closed, drawn;
    this->refine(matches, b, posterior, closed, note);
    this->keep(b, posterior);
    const PoseFactor<Real> factor(posterior);
    PoseGaussian<Real> proposal = posterior;
    if (settings_.mode == EvolutionMode::shared) proposal.mean = centres_[b];
    if (settings_.mode == EvolutionMode::honest) {
      const auto [e0, e1, e2] =
          own_[b].most_probable(matches, b, prior, posterior, this->noise(), settings_.bounds,
                                settings_.evolution, identity(context, Draw::evolution, b));
      proposal.mean = factor.at(e0, e1, e2);
    }

    PoseFactor<Real> about = factor;
    about.mean = proposal.mean;
    const double spread = pays_for_draw() ? std::sqrt(settings_.inflation) : 1.0;
    pose = draw_from(about, identity(context, Draw::pose_proposal, b), Real(spread));
    this->update_landmarks(matches, b, pose, drawn);
    const Real faults = closed.left_out() + factor.L.faults;
    if (!pays_for_draw()) return {closed.log_density(), faults};
    proposal.covariance = settings_.inflation * proposal.covariance;
    const Real ratio = PoseDensity<Real>(prior)(pose) - PoseDensity<Real>(proposal)(pose);
    return {drawn.log_density() + ratio, faults};
  }

 private:
  bool pays_for_draw() const {
    return settings_.mode == EvolutionMode::honest || settings_.mode == EvolutionMode::shared;
  }
  static StreamIdentity identity(const StepContext& context, Draw purpose, std::size_t b) {
    return context.identity(purpose, static_cast<std::uint32_t>(b * kLanesOf<Real>));
  }

  EvolvedSettings settings_;
  std::vector<PoseGaussian<Real>> predicted_;  ///< of every block, where the cloud is moved
  std::vector<BasicPose<Real>> centres_;       ///< where the cloud moved to
  std::vector<OwnEvolution<Real>> own_;  ///< of every block, where each particle evolves alone
  CloudEvolution<Real> cloud_;
};

}  // namespace montecarta
