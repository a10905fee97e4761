// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/stream.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// The random numbers of evolve(). Lane l uses the stream with index identity.index + l, from block
/// `first_block` on. The caller may have used the blocks before it.
struct EvolutionDraws {
  StreamIdentity identity;
  std::uint32_t first_block = 0;
};

namespace evolution {

/// Indices of three members, whole numbers in every lane, different from each other and the target.
template <class Real>
using Members = std::array<Real, 3>;

/// Splits a uniform number in (0, 1) into a digit in {0, ..., count - 1}, which is returned, and
/// another uniform number made of the unused bits, which replaces `uniform`.
template <class Real>
Real take_digit(Real& uniform, std::size_t count) {
  const Real stretched = uniform * Real(static_cast<double>(count));
  const Real digit = min(floor(stretched), Real(static_cast<double>(count - 1)));
  uniform = stretched - digit;
  return digit;
}

/// Draws r1 and r2 (from `first`) and r0 (from `second`), all different from each other and from
/// `target`; `size` >= 3. If `size` is 3 there is no third member, and r0 must not be used.
template <class Real>
Members<Real> draw_members(std::size_t size, std::size_t target, Real& first, Real& second) {
  // Must be called in increasing order of `taken`.
  const auto leave_out = [](const Real& member, const Real& taken) {
    return select(member >= taken, Real(member + Real(1.0)), member);
  };
  const Real t(static_cast<double>(target));
  const Real r1 = leave_out(take_digit(first, size - 1), t);
  const Real low = min(r1, t), high = max(r1, t);
  const Real r2 = leave_out(leave_out(take_digit(first, size - 2), low), high);
  if (size == 3) return {r1, r2, Real(0.0)};
  const Real least = min(low, r2), most = max(high, r2), middle = low + high + r2 - least - most;
  const Real r0 = take_digit(second, size - 3);
  return {r1, r2, leave_out(leave_out(leave_out(r0, least), middle), most)};
}

/// The random numbers of one trial.
template <class Real, std::size_t D>
struct TrialDraws {
  /// Number of blocks of the stream that are used.
  static constexpr std::uint32_t kBlocks = (2 + D + 1) / 2;
  Members<Real> members;  ///< the members r1, r2, r0
  /// Uniform numbers in (0, 1); -1 for the component that always crosses.
  std::array<Real, D> crosses;

  TrialDraws(const EvolutionDraws& draws, std::uint32_t block, std::size_t size,
             std::size_t target) {
    std::array<Real, 2 * kBlocks> uniform;
    for (std::uint32_t k = 0; k < kBlocks; ++k) {
      const auto pair = uniform_pairs(draws.identity, draws.first_block + block + k, Real());
      uniform[2 * k] = pair.first;
      uniform[2 * k + 1] = pair.second;
    }
    members = draw_members(size, target, uniform[0], uniform[1]);
    const Real crossing = take_digit(uniform[1], D);
    for (std::size_t j = 0; j < D; ++j) {
      crosses[j] = select(crossing == Real(static_cast<double>(j)), Real(-1.0), uniform[2 + j]);
    }
  }
};

}  // namespace evolution

/// The region to which members are confined: centre +- half in every component. `is_angle` marks
/// the components that are angles [rad].
template <class Real, std::size_t D>
struct SearchBox {
  std::array<Real, D> centre;
  std::array<Real, D> half;  ///< half the width of the region, >= 0
  std::array<bool, D> is_angle{};

  /// a - b in component j, wrapped if it is an angle.
  [[gnu::always_inline]] Real difference(std::size_t j, const Real& a, const Real& b) const {
    return is_angle[j] ? wrap(Real(a - b)) : Real(a - b);
  }
  /// Returns `value` if it is inside, else its reflection at the wall that it crossed, clamped.
  [[gnu::always_inline]] Real repaired(std::size_t j, const Real& value) const {
    const Real out = difference(j, value, centre[j]);
    Real in = select(out > half[j], Real(half[j] + half[j] - out), out);
    in = select(out < -half[j], Real(-half[j] - half[j] - out), in);
    in = select(in > half[j], half[j], select(in < -half[j], Real(-half[j]), in));
    const Real inside = select(in == out, value, Real(centre[j] + in));
    return is_angle[j] ? wrap(inside) : inside;
  }
};

/// The member from which a trial starts: DE/best/1 (Ankishan), DE/rand/1 (Havangi eq. 6) or
/// DE/current/1 (Havangi eq. 30, where only selection favours the best member).
enum class EvolutionBase { best, random, target };
/// Their names in options, in the order of the enumerators.
inline const std::vector<std::string> kEvolutionBases{"best", "random", "target"};

struct EvolutionSettings {
  double scale = 0.5;                          ///< F: factor of the difference of two members
  double crossover = 0.8;                      ///< Cr: probability of a crossover, in [0, 1]
  std::size_t generations = 10;                ///< largest number of generations
  EvolutionBase base = EvolutionBase::random;  ///< base of the trial vectors
  double tolerance = 1e-6;                     ///< stop if best and worst fitness differ by less
  double good_enough = std::numeric_limits<double>::infinity();  ///< stop at this fitness
};

/// Memory that evolve() keeps between calls; each thread has its own.
template <class Real, std::size_t D>
struct EvolutionScratch {
  std::vector<std::array<Real, D>> trials;
  /// {member} fitness of the members and of their trials.
  std::vector<Real> fitness, trial_fitness;

  /// Sets the size. The fitness of all members is 0 until they are evaluated.
  void start(std::size_t size) {
    trials.resize(size);
    fitness.assign(size, Real(0.0));
    trial_fitness.assign(size, Real(0.0));
  }
};

/// The fittest member, the first of equals, and its fitness.
template <class Real, std::size_t D>
struct Fittest {
  std::array<Real, D> best;
  Real fitness;
};

/// The fittest member after evolution, and what evolution changed.
template <class Real, std::size_t D>
struct Evolved : Fittest<Real, D> {
  Real generations{0.0};   ///< number of generations until the evolution ended
  Real gain_of_best{0.0};  ///< fitness of the best minus that of the first member before evolution
  Real mean_gain{0.0};     ///< mean over all members of their fitness, after minus before evolution
};

/// Least number of members for which the members of a trial can all differ (EQUATIONS 9).
constexpr std::size_t least_population(EvolutionBase base) {
  return base == EvolutionBase::random ? 4 : 3;
}

namespace evolution {

template <class Real, std::size_t D>
using Population = std::span<std::array<Real, D>>;

/// Returns the best member and the worst fitness.
template <class Real, std::size_t D>
struct Ranking {
  Fittest<Real, D> leader;
  Real worst;

  Ranking(Population<Real, D> population, const std::vector<Real>& fitness)
      : leader{population[0], fitness[0]}, worst(fitness[0]) {
    for (std::size_t i = 1; i < population.size(); ++i) {
      const auto better = fitness[i] > leader.fitness;
      for (std::size_t j = 0; j < D; ++j)
        leader.best[j] = select(better, population[i][j], leader.best[j]);
      leader.fitness = select(better, fitness[i], leader.fitness);
      worst = select(fitness[i] < worst, fitness[i], worst);
    }
  }
  /// Returns the mask of the lanes that go on. A lane that has stopped stays so, since it accepts
  /// no trial.
  auto goes_on(const EvolutionSettings& settings) const {
    return !(leader.fitness - worst < Real(settings.tolerance)) &&
           leader.fitness < Real(settings.good_enough);
  }
};

// The next functions are inlined, since otherwise their arrays of registers pass through memory.

/// The k-th random member of every lane.
template <class Real, std::size_t D>
[[gnu::always_inline]] inline std::array<Real, D> gather(Population<Real, D> population,
                                                         const TrialDraws<Real, D>& draws,
                                                         std::size_t k) {
  constexpr std::size_t lanes = kLanesOf<Real>;
  const double* numbers = reinterpret_cast<const double*>(population.data());
  std::array<std::size_t, lanes> first;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    first[lane] = static_cast<std::size_t>(get(draws.members[k], lane)) * D * lanes + lane;
  }
  std::array<Real, D> member;
  for (std::size_t j = 0; j < D; ++j) {
    member[j] = composed<Real>([&](std::size_t lane) { return numbers[first[lane] + j * lanes]; });
  }
  return member;
}

/// Mutation, binomial crossover and repair of member i (EQUATIONS 9).
template <class Real, std::size_t D>
[[gnu::always_inline]] inline std::array<Real, D> trial(Population<Real, D> population,
                                                        std::size_t i,
                                                        const std::array<Real, D>& leader,
                                                        const SearchBox<Real, D>& box,
                                                        const EvolutionSettings& settings,
                                                        const TrialDraws<Real, D>& draws) {
  const std::array<Real, D> plus = gather(population, draws, 0);
  const std::array<Real, D> minus = gather(population, draws, 1);
  std::array<Real, D> base = leader;
  if (settings.base == EvolutionBase::random) base = gather(population, draws, 2);
  if (settings.base == EvolutionBase::target) base = population[i];
  std::array<Real, D> offspring;
  for (std::size_t j = 0; j < D; ++j) {
    const Real mutant = base[j] + Real(settings.scale) * box.difference(j, plus[j], minus[j]);
    offspring[j] = select(draws.crosses[j] <= Real(settings.crossover), box.repaired(j, mutant),
                          population[i][j]);
  }
  return offspring;
}

/// One synchronous generation: all trials are made from the old members before any is replaced.
template <class Real, std::size_t D, class Evaluate>
void next_generation(Population<Real, D> population, std::size_t generation,
                     const Ranking<Real, D>& ranking, const SearchBox<Real, D>& box,
                     const EvolutionSettings& settings, const EvolutionDraws& draws,
                     EvolutionScratch<Real, D>& scratch, const Evaluate& evaluate) {
  const std::size_t size = population.size();
  const auto goes_on = ranking.goes_on(settings);
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t block = (generation * size + i) * TrialDraws<Real, D>::kBlocks;
    const TrialDraws<Real, D> chance(draws, static_cast<std::uint32_t>(block), size, i);
    scratch.trials[i] = trial(population, i, ranking.leader.best, box, settings, chance);
  }
  evaluate(std::span(std::as_const(scratch.trials)), std::span(scratch.trial_fitness));
  for (std::size_t i = 0; i < size; ++i) {
    const auto moves_in = goes_on && scratch.trial_fitness[i] >= scratch.fitness[i];
    for (std::size_t j = 0; j < D; ++j)
      population[i][j] = select(moves_in, scratch.trials[i][j], population[i][j]);
    scratch.fitness[i] = select(moves_in, scratch.trial_fitness[i], scratch.fitness[i]);
  }
}

}  // namespace evolution

/// Evaluates candidates one after the other: `objective(member, candidate)` is the fitness.
auto one_by_one(const auto& objective) {
  return [objective](const auto& candidates, const auto& fitness) {
    for (std::size_t i = 0; i < candidates.size(); ++i) fitness[i] = objective(i, candidates[i]);
  };
}

/// Sum of the fitness of all members.
template <class Real>
Real sum_of_fitness(const std::vector<Real>& fitness) {
  Real sum(0.0);
  for (const Real& one : fitness) sum += one;
  return sum;
}

/// Differential evolution (EQUATIONS 9): moves `population` towards greater fitness and returns the
/// best member. `evaluate(candidates, fitness)` writes the fitness of a candidate for each member;
/// lanes that it never writes stop before the first generation. If `Real` is Lanes, every lane
/// evolves its own population with its own random numbers. Members must lie in `box`. With fewer
/// members than least_population() nothing moves. Allocates only when `scratch` has to grow.
template <class Real, std::size_t D, class Evaluate>
Evolved<Real, D> evolve(std::span<std::array<Real, D>> population, const SearchBox<Real, D>& box,
                        const EvolutionSettings& settings, const EvolutionDraws& draws,
                        EvolutionScratch<Real, D>& scratch, const Evaluate& evaluate) {
  scratch.start(population.size());
  evaluate(std::span<const std::array<Real, D>>(population), std::span(scratch.fitness));
  const Real first = scratch.fitness.front(), before = sum_of_fitness(scratch.fitness);
  Real generations(0.0);
  evolution::Ranking<Real, D> ranking(population, scratch.fitness);
  const bool can_evolve = population.size() >= least_population(settings.base);
  for (std::size_t g = 0; can_evolve && g < settings.generations; ++g) {
    const auto goes_on = ranking.goes_on(settings);
    if (!any(goes_on)) break;
    generations += select(goes_on, Real(1.0), Real(0.0));
    evolution::next_generation(population, g, ranking, box, settings, draws, scratch, evaluate);
    ranking = evolution::Ranking<Real, D>(population, scratch.fitness);
  }
  const Real gain = sum_of_fitness(scratch.fitness) - before;
  return {ranking.leader, generations, ranking.leader.fitness - first,
          gain / Real(static_cast<double>(population.size()))};
}

}  // namespace montecarta::filters
