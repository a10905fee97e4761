// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/evolution/differential_evolution.hpp"
#include "filters/fastslam/packed_candidates.hpp"
#include "filters/fastslam/pose_fitness.hpp"

#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace montecarta::filters {

/// Evolves a population for every particle of one block apart from all others, in standard
/// deviations of the particle's refined Gaussian (EQUATIONS 10).
template <class Real>
class OwnEvolution {
 public:
  /// `population` members, at least seven, for each of the block's `particles`.
  OwnEvolution(std::size_t particles, std::size_t population)
      : population_(population), packed_(particles, population) {}

  /// The most probable pose that is found within `bounds` standard deviations, in standard
  /// deviations of `refined`: where the particles of block b, who expected `predicted`, take the
  /// detections for what `association` says.
  template <class Associating>
  std::array<Real, 3> most_probable(const Associating& association, std::size_t b,
                                    const PoseGaussian<Real>& predicted,
                                    const PoseGaussian<Real>& refined, const SensorNoise& noise,
                                    double bounds, const EvolutionSettings& settings,
                                    const StreamIdentity& chance) {
    look(association, b, predicted, refined, noise);
    if (scan_.empty()) return {Real(0.0), Real(0.0), Real(0.0)};
    begin(bounds, chance);
    const Real bound(bounds);
    const SearchBox<Real, 3> box{{Real(0.0), Real(0.0), Real(0.0)}, {bound, bound, bound}, {}};
    return evolve<Real, 3>(
               population_, box, settings, EvolutionDraws{chance, first_block()}, scratch_,
               [&](Candidates candidates, std::span<Real> fitness) { judge(candidates, fitness); })
        .best;
  }

 private:
  using Candidates = std::span<const std::array<Real, 3>>;

  /// What the particles of block b believe, in the order of packed candidates.
  template <class Associating>
  void look(const Associating& association, std::size_t b, const PoseGaussian<Real>& predicted,
            const PoseGaussian<Real>& refined, const SensorNoise& noise) {
    fitness_.clear(), factors_.clear(), scan_.clear(), packed_scan_.clear();
    append_matched(association, b, scan_);
    for (std::size_t p = 0; p < packed_.patterns(); ++p) {
      fitness_.emplace_back(packed_.pattern_of(predicted, p), noise);
      factors_.emplace_back(packed_.pattern_of(refined, p));
      for (const MatchedDetection<Real>& one : scan_)
        packed_scan_.push_back(packed_.pattern_of(one, p));
    }
  }

  void judge(Candidates candidates, std::span<Real> fitness) const {
    const std::size_t patterns = packed_.patterns();
    for (std::size_t q = 0; q < packed_.blocks(); ++q) {
      const std::size_t p = q % patterns;
      const std::array<Real, 3> c = packed_.pack(candidates, q);
      const Real fit =
          fitness_[p].posterior(factors_[p].at(c[0], c[1], c[2]),
                                std::span(packed_scan_).subspan(p * scan_.size(), scan_.size()));
      packed_.unpack(fit, q, fitness);
    }
  }

  /// Of the stream, behind those that the first generation is drawn from.
  std::uint32_t first_block() const { return 2 * static_cast<std::uint32_t>(population_.size()); }

  /// The centre, the sigma points, and draws, kept within bounds.
  void begin(double bounds, const StreamIdentity& identity) {
    const Real bound(bounds);
    const auto inside = [&](const Real& e) {
      return select(e > bound, bound, select(e < -bound, Real(-bound), e));
    };
    population_.assign(population_.size(), {Real(0.0), Real(0.0), Real(0.0)});
    for (std::size_t j = 0; j < 3; ++j) {
      population_[1 + j][j] = inside(Real(std::sqrt(3.0)));
      population_[4 + j][j] = inside(Real(-std::sqrt(3.0)));
    }
    for (std::uint32_t i = 7; i < population_.size(); ++i) {
      const auto [e0, e1] = normal_pairs<Real>(identity, 2 * i);
      const Real e2 = normal_pairs<Real>(identity, 2 * i + 1).first;
      population_[i] = {inside(e0), inside(e1), inside(e2)};
    }
  }

  std::vector<std::array<Real, 3>> population_;
  PackedCandidates<Real> packed_;
  std::vector<PoseFitness<Real>> fitness_;           ///< of every pattern of packed lanes
  std::vector<PoseFactor<Real>> factors_;            ///< the same
  std::vector<MatchedDetection<Real>> scan_;         ///< of every detection
  std::vector<MatchedDetection<Real>> packed_scan_;  ///< {pattern, detection}
  EvolutionScratch<Real, 3> scratch_;
};

}  // namespace montecarta::filters
