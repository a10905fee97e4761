// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/bootstrap.hpp"

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/quantile.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/errors.hpp"
#include "engine/numbers/lanes.hpp"
#include "engine/random/stream.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kMostReplicates = 2000, kFewestReplicates = 400;
constexpr std::size_t kMostDraws = 20'000'000;
constexpr std::size_t kMostRunsToDraw = 20'000;
constexpr std::size_t kSums = engine::Lanes::kSize;  // number of sums that grow at once

/// Student's quantile for this number of runs, widened for the bootstrap; it takes the place of the
/// normal one.
double widened_deviate(std::size_t runs, double level) {
  const auto n = static_cast<double>(runs);
  return std::sqrt(n / (n - 1.0)) * t_score(level, n - 1.0);
}

/// Share of the replicates below the mean, in normal deviates; ties count half.
double bias_deviate(const std::vector<double>& means, double mean) {
  double below = 0.0;
  for (const double one : means) below += one < mean ? 1.0 : one == mean ? 0.5 : 0.0;
  const auto n = static_cast<double>(means.size());
  return normal_quantile(std::clamp(below / n, 0.5 / n, 1.0 - 0.5 / n));
}

Interval accelerated_interval(std::vector<double>& means, const SampleShape& shape,
                              double deviate) {
  if (!std::isfinite(shape.mean) || !std::isfinite(shape.acceleration)) return {kNaN, kNaN};
  const double bias = bias_deviate(means, shape.mean);
  const auto end = [&](double z) {
    const double shifted = bias + z;
    return quantile_of(means, normal_cdf(bias + shifted / (1.0 - shape.acceleration * shifted)));
  };
  const double lower = end(-deviate);
  return {lower, end(deviate)};
}

/// Student's interval of the mean; NaN if a value is not finite.
Interval t_interval(const std::vector<double>& values, double level) {
  const Interval interval = summary_of(values).interval(level);
  return std::isfinite(interval.upper - interval.lower) ? interval : Interval{kNaN, kNaN};
}

bool all_finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

}  // namespace

std::size_t bootstrap_replicates(std::size_t runs) {
  return std::clamp(kMostDraws / std::max<std::size_t>(runs, 1), kFewestReplicates,
                    kMostReplicates);
}

void draw_runs(std::size_t runs, std::size_t b, std::vector<std::uint32_t>& drawn) {
  RngStream draw({.seed = 0,
                  .run = 0,
                  .step = 0,
                  .index = static_cast<std::uint32_t>(b),
                  .purpose = Draw::analysis_bootstrap});
  drawn.resize(runs);
  for (std::uint32_t& index : drawn) index = draw.below(static_cast<std::uint32_t>(runs));
}

std::vector<Interval> bootstrap_means(std::span<const std::vector<double>> columns, double level) {
  std::vector<Interval> intervals(columns.size(), {kNaN, kNaN});
  const std::size_t runs = columns.empty() ? 0 : columns.front().size();
  if (runs < 2) return intervals;
  if (runs > kMostRunsToDraw) {
    std::ranges::transform(columns, intervals.begin(), [&](const std::vector<double>& column) {
      return t_interval(column, level);
    });
    return intervals;
  }
  const std::size_t replicates = bootstrap_replicates(runs);
  std::vector<std::size_t> known;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    expect(columns[c].size() == runs, "columns of a bootstrap have a value a run");
    if (all_finite(columns[c])) known.push_back(c);
  }
  const std::size_t width = (known.size() + kSums - 1) / kSums * kSums;
  std::vector<double> rows(runs * width);  // {run, known column} values, row by row
  for (std::size_t i = 0; i < runs; ++i) {
    for (std::size_t k = 0; k < known.size(); ++k) rows[i * width + k] = columns[known[k]][i];
  }
  std::vector<std::vector<double>> means(width, std::vector<double>(replicates));
  std::vector<std::uint32_t> drawn;
  for (std::size_t b = 0; b < replicates; ++b) {
    draw_runs(runs, b, drawn);
    for (std::size_t first = 0; first < width; first += kSums) {
      engine::Lanes sums(0.0);  // sums of as many columns as a register holds
      for (const std::uint32_t i : drawn) {
        sums = sums + engine::Lanes::load_unaligned(rows.data() + i * width + first);
      }
      for (std::size_t k = 0; k < kSums; ++k)
        means[first + k][b] = sums.get(k) / static_cast<double>(runs);
    }
  }
  const double deviate = widened_deviate(runs, level);
  for (std::size_t k = 0; k < known.size(); ++k) {
    const std::vector<double>& column = columns[known[k]];
    intervals[known[k]] = accelerated_interval(means[k], shape_of(column), deviate);
  }
  return intervals;
}

Interval bootstrap_mean(std::span<const double> values, double level) {
  const std::vector<double> column(values.begin(), values.end());
  return bootstrap_means(std::span(&column, 1), level).front();
}

}  // namespace montecarta::analysis
