// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/group_sequential.hpp"

#include "analysis/statistics/whole_run_band.hpp"

#include <boost/math/distributions/normal.hpp>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kGridCells = 128;  // even; Simpson's rule

/// Simpson's weights over [-1, 1].
std::vector<double> simpson_weights() {
  std::vector<double> weights(kGridCells + 1, 4.0);
  for (std::size_t i = 0; i <= kGridCells; i += 2) weights[i] = 2.0;
  weights.front() = weights.back() = 1.0;
  for (double& weight : weights) weight *= 2.0 / (3.0 * static_cast<double>(kGridCells));
  return weights;
}

double normal_density(double x) {
  return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
}

double grid_place(std::size_t i, double reach) {
  return reach * (2.0 * static_cast<double>(i) / static_cast<double>(kGridCells) - 1.0);
}

}  // namespace

// The density of what has not crossed, look by look (Armitage, McPherson, Rowe 1969): a sum over
// twice as many runs is sqrt(1/2) times the one before and as much of its own.
double crossing_probability(std::uint64_t looks, double single) {
  const double half = std::sqrt(0.5);
  const double reach = boost::math::quantile(
      boost::math::complement(boost::math::normal_distribution<>(), 0.5 * single));
  const std::vector<double> weights = simpson_weights();
  std::vector<double> density(kGridCells + 1);
  for (std::size_t i = 0; i <= kGridCells; ++i) density[i] = normal_density(grid_place(i, reach));
  std::vector<double> step;  // {to, from} from one look to the next, times the weight of `from`
  for (std::size_t to = 0; to <= kGridCells; ++to) {
    for (std::size_t from = 0; from <= kGridCells; ++from) {
      const double own = grid_place(to, reach) / half - grid_place(from, reach);
      step.push_back(reach * weights[from] * normal_density(own) / half);
    }
  }
  for (std::uint64_t look = 1; look < looks; ++look) {
    std::vector<double> next;
    for (std::size_t to = 0; to <= kGridCells; ++to) {
      const auto row = step.begin() + static_cast<std::ptrdiff_t>(to * density.size());
      next.push_back(std::inner_product(density.begin(), density.end(), row, 0.0));
    }
    density = std::move(next);
  }
  double inside = 0.0;
  for (std::size_t i = 0; i <= kGridCells; ++i) inside += reach * weights[i] * density[i];
  return 1.0 - inside;
}

double level_of_a_look(double level, std::uint64_t looks) {
  if (looks <= 1) return level;
  const auto n = static_cast<double>(looks);
  const auto rejected = [&](double at_a_look) {
    return crossing_probability(looks, at_a_look / (1.0 + kBandShare)) +
           n * at_a_look * kBandShare / (1.0 + kBandShare);
  };
  double low = (1.0 - level) / n, high = 1.0 - level;
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = 0.5 * (low + high);
    (rejected(middle) > 1.0 - level ? high : low) = middle;
  }
  return 1.0 - low;
}

}  // namespace montecarta::analysis
