// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/stream.hpp"
#include "filters/evolution/differential_evolution.hpp"
#include "filters/plain/gaussian.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace montecarta::filters::plain {

/// Differential evolution (EQUATIONS 9; Storn and Price 1995) of vectors of D numbers, with
/// binomial crossover. Generation g draws some blocks of a stream for member i. A block is a pair
/// of numbers: two numbers choose the mates, and D choose the components that cross.
template <int D>
class Evolution {
 public:
  using Member = Vector<D>;
  using Fitness = std::function<double(std::size_t member, const Member& candidate)>;

  EvolutionSettings settings;
  Member half = Member::Zero();  ///< half the sides of the box around the origin
  bool last_is_an_angle = false;

  // All decisions whether a trial replaces a member, so that a test can tell if rounding
  // decided.
  std::size_t accepted = 0;
  std::size_t decisions = 0;
  double closest_call = 1.0;  ///< least difference of fitness between two different places

  /// Evolves `population` and returns its best member, of equal ones the first.
  Member best_of(std::vector<Member>& population, const StreamIdentity& chance,
                 std::uint32_t first_block, const Fitness& fitness) {
    std::vector<double> J;
    for (std::size_t i = 0; i < population.size(); ++i) J.push_back(fitness(i, population[i]));
    const std::size_t fewest = least_population(settings.base);
    for (std::size_t g = 0; g < settings.generations && population.size() >= fewest; ++g) {
      const auto [worst, best] = std::minmax_element(J.begin(), J.end());
      if (*best - *worst < settings.tolerance || *best >= settings.good_enough) break;
      const Member leader = population[leader_of(J)];
      std::vector<Member> trials;
      for (std::size_t i = 0; i < population.size(); ++i) {
        const std::size_t block = first_block + kBlocks * (g * population.size() + i);
        trials.push_back(
            trial(population, i, leader, RngStream(chance, static_cast<std::uint32_t>(block))));
      }
      for (std::size_t i = 0; i < population.size(); ++i)
        select(i, trials[i], population, J, fitness);
    }
    return population[leader_of(J)];
  }

 private:
  static constexpr std::size_t kBlocks = (2 + D + 1) / 2;  ///< of a stream, for one trial

  static std::size_t leader_of(const std::vector<double>& J) {
    return static_cast<std::size_t>(std::ranges::max_element(J) - J.begin());
  }

  /// EQUATIONS (9.2).
  void select(std::size_t i, const Member& trial, std::vector<Member>& population,
              std::vector<double>& J, const Fitness& fitness) {
    const double fitness_of_trial = fitness(i, trial), difference = fitness_of_trial - J[i];
    ++decisions;
    if ((trial - population[i]).norm() >= 1e-9 && difference != 0.0)
      closest_call = std::min(closest_call, std::abs(difference));
    if (fitness_of_trial < J[i]) return;
    population[i] = trial, J[i] = fitness_of_trial;
    ++accepted;
  }

  /// EQUATIONS (9.1).
  Member trial(const std::vector<Member>& population, std::size_t i, const Member& leader,
               RngStream draw) const {
    double first = draw.uniform(), second = draw.uniform();
    std::vector<std::size_t> others;
    for (std::size_t k = 0; k < population.size(); ++k) {
      if (k != i) others.push_back(k);
    }
    const Member& plus = population[taken(others, first)];
    const Member& minus = population[taken(others, first)];
    const Member other = others.empty() ? leader : population[taken(others, second)];
    const Member& base = settings.base == EvolutionBase::best     ? leader
                         : settings.base == EvolutionBase::random ? other
                                                                  : population[i];
    const auto crosses_anyway = static_cast<Eigen::Index>(digit(second, D));
    Member offspring = population[i];
    for (Eigen::Index j = 0; j < D; ++j) {
      const bool crosses = draw.uniform() <= settings.crossover || j == crosses_anyway;
      if (!crosses) continue;
      const bool turns = last_is_an_angle && j == D - 1;
      const double way = plus(j) - minus(j);
      offspring(j) = repaired(j, base(j) + settings.scale * (turns ? wrap(way) : way), turns);
    }
    return offspring;
  }

  /// Reflected once at the wall, then clamped.
  double repaired(Eigen::Index j, double value, bool turns) const {
    if (turns) value = wrap(value);
    if (value > half(j)) value = 2.0 * half(j) - value;
    if (value < -half(j)) value = -2.0 * half(j) - value;
    value = std::clamp(value, -half(j), half(j));
    return turns ? wrap(value) : value;
  }

  /// A whole number below `count` from a uniform number, which keeps the rest of its digits.
  static std::size_t digit(double& uniform, std::size_t count) {
    uniform *= static_cast<double>(count);
    const double whole = std::min(std::floor(uniform), static_cast<double>(count) - 1.0);
    uniform -= whole;
    return static_cast<std::size_t>(whole);
  }
  /// Removes one of `others` and returns it.
  static std::size_t taken(std::vector<std::size_t>& others, double& uniform) {
    const std::size_t at = digit(uniform, others.size()), one = others[at];
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(at));
    return one;
  }
};

}  // namespace montecarta::filters::plain
