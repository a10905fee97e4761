// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/stream.hpp"
#include "tests/filters/reference/unscented.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace montecarta::reference {

/// Differential evolution (SPEC 12), DE/best/1/bin, of vectors of three, literally. Generation g
/// draws for member i three blocks of a stream: two numbers for who mates, three for who crosses.
class Evolution {
 public:
  using Member = Vector<3>;
  using Fitness = std::function<double(std::size_t member, const Member& candidate)>;

  double scale = 0.4;             ///< F
  double crossover = 0.8;         ///< Cr
  std::size_t generations = 10;   ///< at most
  double tolerance = 1e-6;        ///< of fitness, at which all are equally good
  Member half = Member::Zero();   ///< of the box about the origin
  bool last_is_an_angle = false;  ///< the third component

  std::size_t accepted = 0;   ///< trials that moved in
  std::size_t decisions = 0;  ///< whether one does
  double closest_call = 1.0;  ///< least difference of fitness, but for none, of two places

  /// Evolves `population` and returns its best, of equals the first.
  Member best_of(std::vector<Member>& population, const StreamIdentity& chance,
                 std::uint32_t first_block, const Fitness& fitness) {
    std::vector<double> J;
    for (std::size_t i = 0; i < population.size(); ++i) J.push_back(fitness(i, population[i]));
    for (std::size_t g = 0; g < generations && population.size() >= 3; ++g) {
      const Member leader = population[leader_of(J)];
      if (*std::max_element(J.begin(), J.end()) - *std::min_element(J.begin(), J.end()) < tolerance)
        break;
      std::vector<Member> trials;
      for (std::size_t i = 0; i < population.size(); ++i) {
        const std::size_t block = first_block + 3 * (g * population.size() + i);
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
    if (!others.empty()) taken(others, second);  // r0 of DE/rand/1
    const std::size_t crosses_anyway = digit(second, 3);
    Member offspring = population[i];
    for (std::size_t j = 0; j < 3; ++j) {
      const bool crosses = draw.uniform() <= crossover || j == crosses_anyway;
      if (!crosses) continue;
      const auto at = static_cast<Eigen::Index>(j);
      const bool turns = last_is_an_angle && j == 2;
      const double way = plus(at) - minus(at);
      offspring(at) = repaired(at, leader(at) + scale * (turns ? wrap(way) : way), turns);
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

}  // namespace montecarta::reference
