// SPDX-License-Identifier: BSD-3-Clause
#include "engine/particles/resampling.hpp"

#include <cmath>
#include <cstddef>

namespace montecarta::engine {
namespace {

using Parents = std::span<std::uint32_t>;
using Weights = std::span<const double>;

/// The last particle with a positive weight, which gets the remainder due to rounding.
std::size_t last_alive(Weights weights) {
  std::size_t last = weights.size() - 1;
  while (last > 0 && !(weights[last] > 0.0)) --last;
  return last;
}

/// Parent i is the first particle up to which the shares sum to more than place(i). The places must
/// be in increasing order.
template <class Share, class Place>
void sweep(const Share& share, std::size_t last, const Place& place, Parents parents) {
  std::size_t parent = 0;
  double sum = share(0);
  for (std::size_t i = 0; i < parents.size(); ++i) {
    const double here = place(i);
    while (sum <= here && parent < last) sum += share(++parent);
    parents[i] = static_cast<std::uint32_t>(parent);
  }
}

double uniform(const StepContext& context, std::size_t index) {
  return context.stream(Draw::resampling, static_cast<std::uint32_t>(index)).uniform();
}

void systematic(Weights weights, const StepContext& context, Parents parents) {
  const double n = static_cast<double>(parents.size());
  const double start = uniform(context, 0);
  sweep([&](std::size_t j) { return weights[j]; }, last_alive(weights),
        [&](std::size_t i) { return (static_cast<double>(i) + start) / n; }, parents);
}

void stratified(Weights weights, const StepContext& context, Parents parents) {
  const double n = static_cast<double>(parents.size());
  sweep([&](std::size_t j) { return weights[j]; }, last_alive(weights),
        [&](std::size_t i) { return (static_cast<double>(i) + uniform(context, i)) / n; }, parents);
}

/// The ordered uniform numbers are arrival times of a Poisson process divided by the last one.
void multinomial(Weights weights, const StepContext& context, Parents parents) {
  const auto waiting = [&](std::size_t i) { return -std::log(uniform(context, i)); };
  double total = 0.0;
  for (std::size_t i = 0; i <= parents.size(); ++i) total += waiting(i);
  double arrival = 0.0;
  sweep([&](std::size_t j) { return weights[j]; }, last_alive(weights),
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
  sweep([&](std::size_t j) { return n * weights[j] - std::floor(n * weights[j]); },
        last_alive(weights),
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
