// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/stream.hpp"
#include "tests/filters/reference/fast_slams.hpp"
#include "tests/filters/reference/unscented.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace montecarta::filters::reference {

/// What a trial starts from (EQUATIONS 9): DE/best/1, DE/rand/1, DE/current/1.
enum class Base { best, random, target };

/// Differential evolution (EQUATIONS 9) with binomial crossover, of vectors of D numbers,
/// literally. Generation g draws for member i some blocks of a stream, which are pairs: two numbers
/// for who mates, D for who crosses.
template <int D>
class Evolution : public EvolutionRecord {
 public:
  using Member = Vector<D>;
  using Fitness = std::function<double(std::size_t member, const Member& candidate)>;

  Base base = Base::best;
  double scale = 0.4;            ///< F
  double crossover = 0.8;        ///< Cr
  std::size_t generations = 10;  ///< at most
  double tolerance = 1e-6;       ///< of fitness, at which all are equally good
  double good_enough = std::numeric_limits<double>::infinity();  ///< fitness that ends the search
  Member half = Member::Zero();                                  ///< of the box about the origin
  bool last_is_an_angle = false;                                 ///< the last component

  /// Evolves `population` and returns its best, of equals the first.
  Member best_of(std::vector<Member>& population, const StreamIdentity& chance,
                 std::uint32_t first_block, const Fitness& fitness) {
    std::vector<double> J;
    for (std::size_t i = 0; i < population.size(); ++i) J.push_back(fitness(i, population[i]));
    const std::size_t fewest = base == Base::random ? 4 : 3;
    for (std::size_t g = 0; g < generations && population.size() >= fewest; ++g) {
      const Member leader = population[leader_of(J)];
      const auto [worst, best] = std::minmax_element(J.begin(), J.end());
      if (*best - *worst < tolerance || *best >= good_enough) break;
      std::vector<Member> trials;
      for (std::size_t i = 0; i < population.size(); ++i) {
        const std::size_t block = first_block + kBlocks * (g * population.size() + i);
        trials.push_back(
            trial(population, i, leader, RngStream(chance, static_cast<std::uint32_t>(block))));
      }
      for (std::size_t i = 0; i < population.size(); ++i) {
        const double there = fitness(i, trials[i]);
        note(there - J[i], trials[i] - population[i]);
        if (there < J[i]) continue;
        population[i] = trials[i], J[i] = there;
        ++accepted;
      }
    }
    return population[leader_of(J)];
  }

 private:
  static constexpr std::size_t kBlocks = (2 + D + 1) / 2;  ///< of a stream, for one trial

  static std::size_t leader_of(const std::vector<double>& J) {
    return static_cast<std::size_t>(std::max_element(J.begin(), J.end()) - J.begin());
  }

  Member trial(const std::vector<Member>& population, std::size_t i, const Member& leader,
               RngStream draw) const {
    double first = draw.uniform(), second = draw.uniform();
    std::vector<std::size_t> others;
    for (std::size_t k = 0; k < population.size(); ++k) {
      if (k != i) others.push_back(k);
    }
    const Member plus = population[taken(others, first)];
    const Member minus = population[taken(others, first)];
    const Member other = others.empty() ? leader : population[taken(others, second)];
    const Member from = base == Base::best ? leader : base == Base::random ? other : population[i];
    const auto crosses_anyway = static_cast<Eigen::Index>(digit(second, D));
    Member offspring = population[i];
    for (Eigen::Index j = 0; j < D; ++j) {
      const bool crosses = draw.uniform() <= crossover || j == crosses_anyway;
      if (!crosses) continue;
      const bool turns = last_is_an_angle && j == D - 1;
      const double way = plus(j) - minus(j);
      offspring(j) = repaired(j, from(j) + scale * (turns ? wrap(way) : way), turns);
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

  /// A number below `count` out of a uniform one, which keeps what is left of it.
  static std::size_t digit(double& uniform, std::size_t count) {
    uniform *= static_cast<double>(count);
    const double whole = std::min(std::floor(uniform), static_cast<double>(count) - 1.0);
    uniform -= whole;
    return static_cast<std::size_t>(whole);
  }
  /// One of `others`, which it leaves.
  static std::size_t taken(std::vector<std::size_t>& others, double& uniform) {
    const std::size_t at = digit(uniform, others.size()), one = others[at];
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(at));
    return one;
  }

  /// Between a member and its likeness it does not matter what rounding decides.
  void note(double gain, const Member& way) {
    ++decisions;
    if (way.norm() < 1e-9 || gain == 0.0) return;
    closest_call = std::min(closest_call, std::abs(gain));
  }
};

}  // namespace montecarta::filters::reference
