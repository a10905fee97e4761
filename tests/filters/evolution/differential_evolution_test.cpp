// SPDX-License-Identifier: BSD-3-Clause
#include "filters/evolution/differential_evolution.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <span>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr std::array kBases{EvolutionBase::best, EvolutionBase::random, EvolutionBase::target};

template <class Real>
using Candidate = std::array<Real, 3>;
template <class Real>
using Candidates = std::vector<Candidate<Real>>;

/// x [m], y [m], heading about half a turn, where angles wrap.
template <class Real>
SearchBox<Real, 3> box() {
  return {
      {Real(1.0), Real(-2.0), Real(3.1)}, {Real(2.0), Real(1.0), Real(0.5)}, {false, false, true}};
}

/// Lane l of the population is that of particle `first` + l.
template <class Real>
Candidates<Real> scattered(std::size_t size, std::uint32_t first) {
  Candidates<Real> population(size);
  const SearchBox<double, 3> b = box<double>();
  for (std::size_t lane = 0; lane < kLanesOf<Real>; ++lane) {
    RngStream draw({5, 0, 0, first + static_cast<std::uint32_t>(lane), Draw::test});
    for (Candidate<Real>& member : population) {
      for (std::size_t j = 0; j < 3; ++j) {
        set(member[j], lane, b.repaired(j, b.centre[j] + b.half[j] * (2.0 * draw.uniform() - 1.0)));
      }
    }
  }
  return population;
}

/// Greatest, and zero, at (x, y, heading), which may lie across the backward direction.
template <class Real>
auto hill(double x, double y, double heading) {
  return [=](std::size_t, const Candidate<Real>& c) {
    const Real dx = c[0] - Real(x), dy = c[1] - Real(y);
    const Real dh = wrap(Real(c[2] - Real(heading)));
    return Real(-(dx * dx + 2.0 * (dy * dy) + 0.5 * (dx * dy) + 4.0 * (dh * dh)));
  };
}

EvolutionDraws draws(std::uint32_t first) { return {{9, 2, 7, first, Draw::evolution}, 3}; }

template <class Real, class Objective>
Evolved<Real, 3> evolved(Candidates<Real>& population, const EvolutionSettings& settings,
                         const Objective& objective, std::uint32_t first = 0) {
  EvolutionScratch<Real, 3> scratch;
  return evolve<Real, 3>(population, box<Real>(), settings, draws(first), scratch,
                         one_by_one(objective));
}

TEST(DifferentialEvolution, FindsTheTopOfAQuadraticAcrossTheBackwardDirection) {
  for (const EvolutionBase base : kBases) {
    auto population = scattered<double>(30, 0);
    const auto found = evolved(population, {.generations = 150, .base = base, .tolerance = 1e-12},
                               hill<double>(1.5, -1.7, -3.1));
    EXPECT_NEAR(found.best[0], 1.5, 1e-4);
    EXPECT_NEAR(found.best[1], -1.7, 1e-4);
    EXPECT_NEAR(wrap(found.best[2] + 3.1), 0.0, 1e-4);
    EXPECT_NEAR(found.fitness, 0.0, 1e-7);
  }
}

TEST(DifferentialEvolution, NeverLeavesTheBoxAndFindsItsEdge) {
  const auto b = box<double>();
  const auto outside = hill<double>(50.0, -1.7, 1.0);
  const auto inside_only = [&](std::size_t member, const Candidate<double>& c) {
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_LE(std::abs(b.difference(j, c[j], b.centre[j])), b.half[j] + 1e-12);
    EXPECT_LE(std::abs(c[2]), kPi);
    return outside(member, c);
  };
  auto population = scattered<double>(20, 0);
  const auto settings = EvolutionSettings{.scale = 1.5, .generations = 60};
  const auto result = evolved(population, settings, inside_only);
  EXPECT_NEAR(result.best[0], 3.0, 0.05);
  EXPECT_NEAR(result.best[2], 2.6, 0.05);
}

TEST(SearchBox, ReflectsOnceAndThenClamps) {
  const auto b = box<double>();
  EXPECT_EQ(b.repaired(0, 2.5), 2.5);
  EXPECT_DOUBLE_EQ(b.repaired(0, 3.25), 2.75);
  EXPECT_DOUBLE_EQ(b.repaired(0, -1.5), -0.5);
  EXPECT_DOUBLE_EQ(b.repaired(0, 100.0), -1.0);  // reflected beyond the other wall
  EXPECT_DOUBLE_EQ(b.repaired(0, -100.0), 3.0);
  EXPECT_DOUBLE_EQ(b.repaired(2, wrap(3.1 + 0.6)), wrap(3.1 + 0.4));
  EXPECT_DOUBLE_EQ(b.repaired(2, 3.1 - 0.6), 3.1 - 0.4);
}

TEST(DifferentialEvolution, DifferencesOfAnglesAreWrapped) {
  Candidates<double> population{{1.0, -2.0, 3.0}, {1.0, -2.0, -3.1}, {1.0, -2.0, 3.05}};
  const double apart = kTwoPi - 6.1;  // of the first two, across the backward direction
  const double best = 3.05;
  std::vector<double> headings;
  evolved(population, {.crossover = 1.0, .generations = 1, .base = EvolutionBase::best},
          [&](std::size_t, const Candidate<double>& c) {
            headings.push_back(c[2]);
            return -std::abs(c[2] - best);
          });
  EXPECT_NEAR(std::abs(wrap(headings.at(5) - best)), 0.5 * apart, 1e-12);  // the third's trial
}

TEST(DifferentialEvolution, MembersOfATrialDifferFromEachOtherAndTheTarget) {
  for (const std::size_t size : {3U, 4U, 7U}) {
    std::set<evolution::Members<double>> met;
    for (std::uint32_t k = 0; k < 4000; ++k) {
      RngStream draw({1, 0, 0, k, Draw::test});
      double first = draw.uniform(), second = draw.uniform();
      const std::size_t target = k % size;
      auto members = evolution::draw_members(size, target, first, second);
      const auto n = static_cast<double>(size);
      if (size == 3) members[2] = n;  // there is no third
      EXPECT_EQ((std::set{static_cast<double>(target), members[0], members[1], members[2]}).size(),
                4U);
      EXPECT_LT(std::max(members[0], members[1]), n);
      met.insert(members);
    }
    const std::size_t n = size;
    EXPECT_EQ(met.size(), n == 3 ? 6 : n * (n - 1) * (n - 2)) << "some choices never come";
  }
}

TEST(DifferentialEvolution, MembersAreDrawnEvenly) {
  std::array<int, 5> count{};
  constexpr int n = 20000;
  for (std::uint32_t k = 0; k < n; ++k) {
    RngStream draw({1, 0, 0, k, Draw::test});
    double first = draw.uniform(), second = draw.uniform();
    for (const double m : evolution::draw_members(5, 2, first, second))
      ++count[static_cast<std::size_t>(m)];
  }
  EXPECT_EQ(count[2], 0);
  const double expected = 3.0 * n / 4.0, sigma = std::sqrt(n * 0.75 * 0.25);
  for (const std::size_t m : {0U, 1U, 3U, 4U}) EXPECT_NEAR(count[m], expected, 5.0 * sigma);
}

TEST(DifferentialEvolution, EveryLaneEvolvesAsItWouldAlone) {
  for (const EvolutionBase base : kBases) {
    for (const std::size_t size : {3U, 4U, 9U}) {
      const EvolutionSettings settings{.generations = 12, .base = base, .tolerance = 1e-3};
      auto together = scattered<Lanes>(size, 16);
      const auto best = evolved(together, settings, hill<Lanes>(1.5, -1.7, -3.1), 16);
      for (std::uint32_t lane = 0; lane < Lanes::kSize; ++lane) {
        auto alone = scattered<double>(size, 16 + lane);
        const auto own = evolved(alone, settings, hill<double>(1.5, -1.7, -3.1), 16 + lane);
        EXPECT_NEAR(get(best.fitness, lane), own.fitness, 1e-12);
        EXPECT_EQ(get(best.generations, lane), own.generations);
        EXPECT_NEAR(get(best.gain_of_best, lane), own.gain_of_best, 1e-12);
        EXPECT_NEAR(get(best.mean_gain, lane), own.mean_gain, 1e-12);
        for (std::size_t i = 0; i < size; ++i) {
          for (std::size_t j = 0; j < 3; ++j)
            EXPECT_NEAR(get(together[i][j], lane), alone[i][j], 1e-12) << lane << ' ' << i;
        }
      }
    }
  }
}

TEST(DifferentialEvolution, ALanesBitsDoNotDependOnItsNeighbours) {
  const EvolutionSettings settings{.generations = 12, .tolerance = 1e-3};
  auto population = scattered<Lanes>(9, 0), other = population;
  for (Candidate<Lanes>& member : other) {
    for (std::size_t lane = 1; lane < Lanes::kSize; ++lane) set(member[0], lane, 1.0);
  }
  evolved(population, settings, hill<Lanes>(1.5, -1.7, -3.1));
  evolved(other, settings, hill<Lanes>(1.5, -1.7, -3.1));
  for (std::size_t i = 0; i < population.size(); ++i) {
    for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(get(population[i][j], 0), get(other[i][j], 0));
  }
}

TEST(DifferentialEvolution, TheBestNeverGetsWorse) {
  for (const EvolutionBase base : kBases) {
    double before = -1e300;
    for (std::size_t generations = 0; generations < 15; ++generations) {
      auto population = scattered<double>(5, 3);
      const auto result = evolved(population, {.generations = generations, .base = base},
                                  hill<double>(1.5, -1.7, -3.1), 3);
      EXPECT_GE(result.fitness, before);
      before = result.fitness;
    }
  }
}

/// The number of evaluations of the objective.
std::size_t evaluations(const EvolutionSettings& settings) {
  std::size_t count = 0;
  auto population = scattered<double>(10, 0);
  const auto top = hill<double>(1.5, -1.7, -3.1);
  evolved(population, settings, [&](std::size_t member, const Candidate<double>& c) {
    ++count;
    return top(member, c);
  });
  return count;
}

TEST(DifferentialEvolution, SaysWhatItChanged) {
  const auto top = hill<double>(1.5, -1.7, -3.1);
  const auto before = scattered<double>(10, 0);
  auto after = before;
  const auto found = evolved(after, {.generations = 400, .tolerance = 1e-4}, top);
  double gain = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) gain += top(i, after[i]) - top(i, before[i]);
  EXPECT_DOUBLE_EQ(found.mean_gain, gain / 10.0);
  EXPECT_DOUBLE_EQ(found.gain_of_best, found.fitness - top(0, before[0]));
  EXPECT_EQ(10U * static_cast<std::size_t>(1.0 + found.generations),
            evaluations({.generations = 400, .tolerance = 1e-4}));
}

TEST(DifferentialEvolution, StopsWhereAllMembersAreEquallyGood) {
  EXPECT_EQ(evaluations({.generations = 20}), 10U * 21U);
  EXPECT_EQ(evaluations({.generations = 20, .tolerance = 1e9}), 10U);
  EXPECT_LT(evaluations({.generations = 400, .tolerance = 1e-4}), 10U * 100U);
}

TEST(DifferentialEvolution, LanesThatNobodyJudgesDoNotKeepTheOthersGoing) {
  const EvolutionSettings settings{.generations = 400, .tolerance = 1e-4};
  EvolutionScratch<Lanes, 3> scratch;
  auto population = scattered<Lanes>(10, 0);
  const auto top = hill<Lanes>(1.5, -1.7, -3.1);
  std::size_t judged = 0;
  evolve<Lanes, 3>(population, box<Lanes>(), settings, draws(0), scratch,
                   [&](std::span<const Candidate<Lanes>> candidates, std::span<Lanes> fitness) {
                     for (std::size_t i = 0; i < candidates.size(); ++i)
                       set(fitness[i], 0, get(top(i, candidates[i]), 0));
                     judged += candidates.size();
                   });
  EXPECT_EQ(judged, evaluations(settings));  // of one that is alone
}

TEST(DifferentialEvolution, StopsWhereTheBestIsGoodEnough) {
  EXPECT_EQ(evaluations({.generations = 20, .good_enough = -1e9}), 10U);
  EXPECT_LT(evaluations({.generations = 400, .good_enough = -0.01}), 10U * 40U);
}

TEST(DifferentialEvolution, TooSmallAPopulationIsLeftAlone) {
  const auto top = hill<double>(1.5, -1.7, -3.1);
  for (const EvolutionBase base : kBases) {
    for (std::size_t size = 1; size <= 4; ++size) {
      const auto before = scattered<double>(size, 0);
      auto after = before;
      const auto result = evolved(after, {.base = base}, top);
      EXPECT_EQ(after == before, size < least_population(base)) << size;
      for (const auto& member : after) EXPECT_GE(result.fitness, top(0, member));
    }
  }
}

TEST(DifferentialEvolution, EveryMemberIsJudgedAsItself) {
  auto population = scattered<double>(8, 0);
  const auto nearest_to_own = [](std::size_t member, const Candidate<double>& c) {
    return -std::abs(c[0] - 0.25 * static_cast<double>(member));
  };
  evolved(population, {.generations = 100, .base = EvolutionBase::target, .tolerance = 0.0},
          nearest_to_own);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(population[i][0], 0.25 * double(i), 0.3) << i;
}

}  // namespace
}  // namespace montecarta::filters
