// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/exit_bootstrap.hpp"

#include "analysis/metrics/consistency.hpp"
#include "engine/random/stream.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace montecarta::analysis {
namespace {

constexpr Eigen::Index kReplicates = 400, kBatch = 16;
constexpr std::uint32_t kPoisson = 0xffffffffU;  // tells these numbers from those of replicates
constexpr double kMostNees = 1e30;               // sums of single precision hold it

/// A Poisson variable of mean 1 from one uniform number.
float poisson(double uniform) {
  double term = std::exp(-1.0), sum = term;
  int k = 0;
  while (uniform > sum && k < 20) sum += term /= ++k;
  return static_cast<float>(k);
}

}  // namespace

ExitBootstrap::ExitBootstrap(std::size_t scans) {
  const auto n = static_cast<Eigen::Index>(scans);
  sums_ = Matrix::Zero(kReplicates, n);
  weights_ = Matrix::Zero(kReplicates, n);
  batch_.resize(kBatch, n);
  is_number_.resize(kBatch, n);
  counts_.resize(kReplicates, kBatch);
}

void ExitBootstrap::add(std::span<const double> nees) {
  for (Eigen::Index s = 0; s < batch_.cols(); ++s) {
    const double value = nees[static_cast<std::size_t>(s)];
    is_number_(waiting_, s) = std::isnan(value) ? 0.0F : 1.0F;
    batch_(waiting_, s) = std::isnan(value) ? 0.0F : static_cast<float>(std::min(value, kMostNees));
  }
  RngStream draw({.seed = 0,
                  .run = runs_++,
                  .step = 0,
                  .index = kPoisson,
                  .purpose = Draw::analysis_bootstrap});
  for (Eigen::Index b = 0; b < kReplicates; ++b) counts_(b, waiting_) = poisson(draw.uniform());
  if (++waiting_ == kBatch) flush();
}

void ExitBootstrap::flush() {
  sums_.noalias() += counts_.leftCols(waiting_) * batch_.topRows(waiting_);
  weights_.noalias() += counts_.leftCols(waiting_) * is_number_.topRows(waiting_);
  waiting_ = 0;
}

double ExitBootstrap::lasting_exit(Eigen::Index replicate, std::span<const double> times,
                                   const UpperEnd& upper_end) const {
  std::vector<bool> above(times.size());
  for (std::size_t s = 0; s < times.size(); ++s) {
    const float weight = weights_(replicate, static_cast<Eigen::Index>(s));
    if (weight == 0.0F) continue;
    const float average = sums_(replicate, static_cast<Eigen::Index>(s)) / weight;
    above[s] = static_cast<double>(average) > upper_end(static_cast<std::uint64_t>(weight));
  }
  const auto exit = first_lasting(above, kLastingScans);
  return exit ? times[*exit] : std::numeric_limits<double>::infinity();
}

std::vector<double> ExitBootstrap::lasting_exits(std::span<const double> times,
                                                 std::size_t dimension, double level) {
  flush();
  std::map<std::uint64_t, double> known;  // nearly all scans have as many runs
  const UpperEnd upper_end = [&](std::uint64_t runs) {
    const auto [found, is_new] = known.try_emplace(runs);
    if (is_new) found->second = nees_bounds(runs, dimension, level).upper;
    return found->second;
  };
  std::vector<double> exits;
  for (Eigen::Index b = 0; b < kReplicates; ++b) exits.push_back(lasting_exit(b, times, upper_end));
  return exits;
}

Interval middle_of(std::vector<double> values, double level) {
  std::ranges::sort(values);
  const double tail = 0.5 * (1.0 - level) * static_cast<double>(values.size());
  const auto low = static_cast<std::size_t>(tail);
  return {values[low], values[values.size() - 1 - low]};
}

}  // namespace montecarta::analysis
