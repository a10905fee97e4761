// SPDX-License-Identifier: BSD-3-Clause
#include "engine/particles/blocks.hpp"
#include "engine/particles/genealogy.hpp"
#include "engine/particles/resampling.hpp"
#include "engine/particles/weights.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace montecarta::engine {
namespace {

StepContext step(std::uint32_t k, const Parallel& threads = Parallel::serial()) {
  return {11, 0, k, threads};
}

/// Calls check(threads) with both backends and several numbers of threads.
template <class Check>
void on_all_threads(const Check& check) {
  for (const Backend backend : {Backend::tbb, Backend::openmp}) {
    for (const int threads : {1, 2, 3, 8}) check(Parallel(backend, threads));
  }
}

TEST(Parts, AreAddedInTheirOrderOnAnyThreads) {
  const std::size_t n = 5 * kParticlesPerSum + 17;
  const auto sum_of = [](std::size_t first, std::size_t many) {
    double sum = 0.0;
    for (std::size_t i = first; i < first + many; ++i) sum += 1.0 / static_cast<double>(i + 1);
    return sum;
  };
  double expected = 0.0;
  for (std::size_t first = 0; first < n; first += kParticlesPerSum)
    expected += sum_of(first, std::min(n - first, kParticlesPerSum));
  EXPECT_NE(expected, sum_of(0, n)) << "the order makes no difference to these numbers";
  on_all_threads([&](const Parallel& threads) {
    EXPECT_EQ(sum_of_parts<double>(step(0, threads), n, sum_of), expected);
    EXPECT_EQ(sum_of_parts<double>(step(0, threads), kParticlesPerSum, sum_of),
              sum_of(0, kParticlesPerSum));
  });
}

TEST(Genealogy, TracesLikeStepByStepCopying) {
  const std::size_t n = 16;
  RngStream draw({5, 0, 0, 0, Draw::test});
  Genealogy genealogy(n);
  std::vector<std::vector<std::uint32_t>> copied_since;  // {generation} by eager copying
  std::vector<std::uint32_t> source(n);
  for (int g = 0; g < 300; ++g) {
    copied_since.emplace_back(n);
    for (std::uint32_t i = 0; i < n; ++i) copied_since.back()[i] = i;
    std::vector<std::uint32_t> parents(n);
    for (auto& parent : parents) parent = draw.below(n);
    if (genealogy.is_long()) {
      genealogy.forget();
      copied_since.erase(copied_since.begin(), copied_since.end() - 1);
    }
    genealogy.add(step(0), parents);
    for (auto& copy : copied_since) {
      std::vector<std::uint32_t> next(n);
      for (std::size_t i = 0; i < n; ++i) next[i] = copy[parents[i]];
      copy = next;
    }
    const auto first = genealogy.generation() - static_cast<std::uint32_t>(copied_since.size());
    for (std::uint32_t k = 0; k < copied_since.size(); k += 37) {
      genealogy.trace(first + k, 0, source);
      ASSERT_EQ(source, copied_since[k]) << "generation " << g;
    }
  }
}

TEST(Blocks, GatherCopiesEveryField) {
  struct Two {
    Lanes a, b;
  };
  std::vector<Two> from(3), to(3);
  std::vector<std::uint32_t> source(24);
  for (std::size_t i = 0; i < 24; ++i) {
    set(from[i / 8].a, i % 8, static_cast<double>(i));
    set(from[i / 8].b, i % 8, -static_cast<double>(i));
    source[i] = static_cast<std::uint32_t>((7 * i + 3) % 24);
  }
  gather<Lanes>(step(0), from, source, to);
  for (std::size_t i = 0; i < 24; ++i) {
    EXPECT_EQ(to[i / 8].a.get(i % 8), source[i]);
    EXPECT_EQ(to[i / 8].b.get(i % 8), -static_cast<double>(source[i]));
  }
}

TEST(Weights, NormaliseReturnsTheEvidenceAndLeavesDeadLanesOut) {
  Weights<Lanes> weights(5);
  weights.multiply(0, Lanes(-1000.0));  // far below the range of exp
  EXPECT_NEAR(weights.normalise(step(0)), -1000.0, 1e-12);
  EXPECT_NEAR(weights.effective(), 5.0, 1e-12);
  Lanes increment(0.0);
  set(increment, 2, std::log(3.0));
  weights.multiply(0, increment);
  EXPECT_NEAR(weights.normalise(step(0)), std::log(7.0 / 5.0), 1e-12);
  EXPECT_NEAR(weights.linear_scalars()[2], 3.0 / 7.0, 1e-12);
  EXPECT_EQ(weights.heaviest(), 2U);
  EXPECT_EQ(get(weights.linear()[0], 6), 0.0);
}

TEST(Weights, SayWhenNoParticleIsLeft) {
  Weights<Lanes> dead(4), wild(4);
  dead.multiply(0, Lanes(-std::numeric_limits<double>::infinity()));
  EXPECT_THROW(dead.normalise(step(0)), std::runtime_error);
  wild.multiply(0, Lanes(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_THROW(wild.normalise(step(0)), std::runtime_error);
}

TEST(Weights, HaveTheSameBitsOnAnyThreads) {
  const std::size_t n = 5 * kParticlesPerSum + 17;
  const auto weighed = [&](const Parallel& threads) {
    RngStream draw({6, 0, 0, 0, Draw::test});
    Weights<Lanes> weights(n);
    for (std::size_t b = 0; b < blocks_for<Lanes>(n); ++b) {
      Lanes increment;
      for (std::size_t lane = 0; lane < kLanesOf<Lanes>; ++lane)
        set(increment, lane, draw.normal());
      weights.multiply(b, increment);
    }
    std::vector<double> numbers{weights.effective(), weights.normalise(step(0, threads)),
                                weights.effective(), static_cast<double>(weights.heaviest())};
    numbers.insert(numbers.end(), weights.log_scalars().begin(), weights.log_scalars().end());
    numbers.insert(numbers.end(), weights.linear_scalars().begin(), weights.linear_scalars().end());
    weights.make_equal(step(0, threads));
    numbers.push_back(weights.effective());
    return numbers;
  };
  const std::vector<double> alone = weighed(Parallel::serial());
  EXPECT_NEAR(alone[0], static_cast<double>(n), 1e-6);
  EXPECT_LT(alone[2], 0.5 * static_cast<double>(n));
  EXPECT_GT(alone[3], static_cast<double>(kParticlesPerSum)) << "not beyond the first part";
  on_all_threads([&](const Parallel& threads) { EXPECT_EQ(weighed(threads), alone); });
}

std::vector<double> random_weights(std::uint32_t seed, std::size_t n) {
  RngStream draw({seed, 0, 0, 0, Draw::test});
  std::vector<double> weights(n);
  double sum = 0.0;
  for (double& w : weights) sum += (w = -std::log(draw.uniform()));
  for (double& w : weights) w /= sum;
  return weights;
}

std::vector<int> children(Resampling scheme, const std::vector<double>& weights, std::uint32_t k) {
  std::vector<std::uint32_t> parents(weights.size());
  draw_parents(scheme, weights, step(k), parents);
  std::vector<int> counts(weights.size(), 0);
  for (std::uint32_t parent : parents) ++counts.at(parent);
  return counts;
}

class Schemes : public testing::TestWithParam<Resampling> {};

TEST_P(Schemes, GiveEachParticleItsShareOnAverage) {
  const auto weights = random_weights(1, 10);
  std::vector<double> mean(10, 0.0);
  const int rounds = 20000;
  for (std::uint32_t k = 0; k < rounds; ++k) {
    const auto counts = children(GetParam(), weights, k);
    for (std::size_t j = 0; j < 10; ++j) mean[j] += counts[j] / static_cast<double>(rounds);
  }
  for (std::size_t j = 0; j < 10; ++j) {  // no scheme varies more than the multinomial one
    const double share = 10 * weights[j];
    EXPECT_NEAR(mean[j], share, 5 * std::sqrt(share * (1 - weights[j]) / rounds))
        << "particle " << j;
  }
}

TEST_P(Schemes, NeverChooseAParticleWithoutWeight) {
  std::vector<double> weights(16, 0.0);
  weights[3] = 0.25, weights[4] = 0.75;
  for (std::uint32_t k = 0; k < 200; ++k) {
    const auto counts = children(GetParam(), weights, k);
    EXPECT_EQ(counts[3] + counts[4], 16);
  }
}

TEST_P(Schemes, SurviveWeightsThatSumToAlmostOne) {
  const std::vector<double> weights(3, (1.0 - 1e-12) / 3.0);
  for (std::uint32_t k = 0; k < 200; ++k) children(GetParam(), weights, k);  // looks up .at(parent)
}

/// The greatest distance of a number of children from its share n w, per scheme; the last
/// population has several parts.
TEST_P(Schemes, KeepNearTheShare) {
  for (std::uint32_t k = 0; k < 501; ++k) {
    const std::size_t n = k < 500 ? 37 : 5 * kParticlesPerSum + 17;
    const auto weights = random_weights(k, n);
    const auto counts = children(GetParam(), weights, k);
    for (std::size_t j = 0; j < n; ++j) {
      const double share = static_cast<double>(n) * weights[j];
      if (GetParam() == Resampling::residual) {
        EXPECT_GE(counts[j], std::floor(share)) << k;
      } else if (GetParam() != Resampling::multinomial) {
        const double most = GetParam() == Resampling::systematic ? 1.0 : 2.0;
        EXPECT_LT(std::abs(counts[j] - share), most) << k;
      }
    }
  }
}

TEST_P(Schemes, ChooseTheSameParentsOnAnyThreads) {
  auto weights = random_weights(2, 5 * kParticlesPerSum + 17);
  std::fill_n(weights.begin() + 1500, 2000, 0.0);  // a part without weight
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& w : weights) w /= sum;
  const auto parents_on = [&](const Parallel& threads) {
    std::vector<std::uint32_t> parents(weights.size());
    draw_parents(GetParam(), weights, step(0, threads), parents);
    return parents;
  };
  const auto alone = parents_on(Parallel::serial());
  for (const std::uint32_t parent : alone) EXPECT_GT(weights.at(parent), 0.0);
  on_all_threads([&](const Parallel& threads) { EXPECT_EQ(parents_on(threads), alone); });
}

INSTANTIATE_TEST_SUITE_P(All, Schemes,
                         testing::Values(Resampling::systematic, Resampling::stratified,
                                         Resampling::residual, Resampling::multinomial));

}  // namespace
}  // namespace montecarta::engine
