// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/evolution/differential_evolution.hpp"
#include "filters/fastslam/pose_fitness.hpp"
#include "filters/moments/anchored_landmark.hpp"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace montecarta {

/// Evolves a population for every particle of one block apart from all others, in standard
/// deviations of the particle's refined Gaussian (SPEC 13, DE-H).
template <class Real>
class OwnEvolution {
 public:
  /// `population` members for each particle, at least seven.
  explicit OwnEvolution(std::size_t population) : population_(population) {}

  /// Looks at what the particles of block b take the detections for.
  template <class Matches>
  void gather(const Matches& matches, std::size_t b) {
    scan_.clear();
    matches.read(b, [&](std::size_t, const auto& landmark, const auto& seen, const auto& mask) {
      scan_.push_back({as_gaussian(landmark), seen, as_number<Real>(mask)});
    });
  }

  /// The most probable pose that is found within `bounds` standard deviations.
  BasicPose<Real> most_probable(const PoseFitness<Real>& fitness, const PoseFactor<Real>& factor,
                                double bounds, const EvolutionSettings& settings,
                                const StreamIdentity& chance) {
    if (scan_.empty()) return factor.mean;
    begin(bounds, chance);
    const Real bound(bounds);
    const SearchBox<Real, 3> box{{Real(0.0), Real(0.0), Real(0.0)}, {bound, bound, bound}, {}};
    const auto objective = [&](std::size_t, const std::array<Real, 3>& c) {
      return fitness.posterior(factor.at(c[0], c[1], c[2]), std::span(std::as_const(scan_)));
    };
    const auto found = evolve<Real, 3>(population_, box, settings,
                                       EvolutionDraws{chance, first_block()}, scratch_, objective);
    return factor.at(found.best[0], found.best[1], found.best[2]);
  }

 private:
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
  std::vector<Sighting<Real>> scan_;
  EvolutionScratch<Real, 3> scratch_;
};

}  // namespace montecarta
