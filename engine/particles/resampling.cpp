// SPDX-License-Identifier: BSD-3-Clause
#include "engine/particles/resampling.hpp"

#include "engine/particles/blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace montecarta::engine {
namespace {

using Parents = std::span<std::uint32_t>;
using Weights = std::span<const double>;

/// The last particle in [first, last] with a positive share, which gets the remainder due to
/// rounding.
template <class Share>
std::size_t last_alive(const Share& share, std::size_t first, std::size_t last) {
  while (last > first && !(share(last) > 0.0)) --last;
  return last;
}
std::size_t last_alive(Weights weights) {
  return last_alive([&](std::size_t j) { return weights[j]; }, 0, weights.size() - 1);
}

/// Consecutive particles, and the new particles [first_child, end) that descend from them.
struct DescendantRow {
  std::size_t first, last;
  double sum_before;  ///< sum of the shares of all particles before the first
  std::size_t first_child, end;
};

/// Draws parents: parent i is the first particle up to which the shares sum to more than place(i).
/// The places must be in increasing order.
template <class Share, class Place>
void sweep(const DescendantRow& family, const Share& share, const Place& place, Parents parents) {
  std::size_t parent = family.first;
  double sum = family.sum_before + share(parent);
  for (std::size_t i = family.first_child; i < family.end; ++i) {
    const double here = place(i);
    while (sum <= here && parent < family.last) sum += share(++parent);
    parents[i] = static_cast<std::uint32_t>(parent);
  }
}

/// The sum of all shares before each part of kParticlesPerSum particles.
template <class Share>
std::vector<double> sums_before_parts(const StepContext& context, const Share& share,
                                      std::size_t particles) {
  const BlockTasks<double> parts(particles, kParticlesPerSum);
  std::vector<double> sums(parts.count());
  parts.run_together(context, [&](std::size_t first, std::size_t n) {
    for (std::size_t j = first; j < first + n; ++j) sums[first / kParticlesPerSum] += share(j);
  });
  double before = 0.0;
  for (double& sum : sums) before += std::exchange(sum, before);
  return sums;
}

/// Draws the parents for all particles up to `last`. Threads share the work by parts of particles;
/// place(i) may be called in any order.
template <class Share, class Place>
void sweep(const StepContext& context, std::size_t last, const Share& share, const Place& place,
           Parents parents) {
  if (last < kParticlesPerSum)
    return sweep({0, last, 0.0, 0, parents.size()}, share, place, parents);
  const std::vector<double> before = sums_before_parts(context, share, last + 1);
  // The first new particle after those of earlier parts.
  const auto first_child = [&](std::size_t part) {
    if (part == before.size()) return parents.size();
    std::size_t first = 0, end = parents.size();
    while (first < end) {
      const std::size_t middle = (first + end) / 2;
      if (place(static_cast<std::uint32_t>(middle)) < before[part]) {
        first = middle + 1;
      } else {
        end = middle;
      }
    }
    return first;
  };
  context.parallel_for(before.size(), [&](std::size_t part) {
    const std::size_t first = part * kParticlesPerSum;
    const std::size_t end = std::min(first + kParticlesPerSum, last + 1);
    const std::size_t heir = end > last ? last : last_alive(share, first, end - 1);
    sweep({first, heir, before[part], first_child(part), first_child(part + 1)}, share, place,
          parents);
  });
}

double uniform(const StepContext& context, std::size_t index) {
  return context.stream(Draw::resampling, static_cast<std::uint32_t>(index)).uniform();
}

void systematic(Weights weights, const StepContext& context, Parents parents) {
  const double n = static_cast<double>(parents.size());
  const double start = uniform(context, 0);
  sweep(
      context, last_alive(weights), [&](std::size_t j) { return weights[j]; },
      [&](std::size_t i) { return (static_cast<double>(i) + start) / n; }, parents);
}

void stratified(Weights weights, const StepContext& context, Parents parents) {
  const double n = static_cast<double>(parents.size());
  sweep(
      context, last_alive(weights), [&](std::size_t j) { return weights[j]; },
      [&](std::size_t i) { return (static_cast<double>(i) + uniform(context, i)) / n; }, parents);
}

/// Draws by ordered uniform numbers, which are the arrival times of a Poisson process divided by
/// the last one.
void multinomial(Weights weights, const StepContext& context, Parents parents) {
  const auto waiting = [&](std::size_t i) { return -std::log(uniform(context, i)); };
  double total = 0.0;
  for (std::size_t i = 0; i <= parents.size(); ++i) total += waiting(i);
  double arrival = 0.0;
  sweep(
      {0, last_alive(weights), 0.0, 0, parents.size()}, [&](std::size_t j) { return weights[j]; },
      [&](std::size_t i) { return (arrival += waiting(i)) / total; }, parents);
}

/// Gives floor(N w) copies to each particle, and the rest by stratified resampling of the
/// remainders (Liu and Chen 1998).
void residual(Weights weights, const StepContext& context, Parents parents) {
  const double n = static_cast<double>(parents.size());
  std::size_t filled = 0;
  for (std::size_t j = 0; j < weights.size(); ++j) {
    const auto copies = static_cast<std::size_t>(n * weights[j]);
    for (std::size_t c = 0; c < copies && filled < parents.size(); ++c) {
      parents[filled++] = static_cast<std::uint32_t>(j);
    }
  }
  sweep(
      context, last_alive(weights),
      [&](std::size_t j) { return n * weights[j] - std::floor(n * weights[j]); },
      [&](std::size_t i) { return static_cast<double>(i) + uniform(context, i); },
      parents.subspan(filled));
}

}  // namespace

void draw_parents(Resampling scheme, Weights weights, const StepContext& context, Parents parents) {
  switch (scheme) {
    case Resampling::systematic:
      return systematic(weights, context, parents);
    case Resampling::stratified:
      return stratified(weights, context, parents);
    case Resampling::multinomial:
      return multinomial(weights, context, parents);
    case Resampling::residual:
      return residual(weights, context, parents);
  }
}

}  // namespace montecarta::engine
