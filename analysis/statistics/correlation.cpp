// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/correlation.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kEveryLag = 128;  // up to here, then in steps that grow with the lag
constexpr double kLagGrowth = 1.05;
constexpr double kWindow = 5.0;
constexpr double kChanceFactor = 4.0;  // times its mean by chance

/// `of(lag)` at few lags, linear in between: a long series costs n log n.
template <class Function>
std::vector<double> at_all_lags(std::size_t samples, const Function& of) {
  std::vector<double> values(samples);
  std::size_t last = 0;
  for (std::size_t lag = 1; lag < samples;) {
    values[lag] = of(lag);
    for (std::size_t h = last + 1; h < lag; ++h) {
      const double share = static_cast<double>(h - last) / static_cast<double>(lag - last);
      values[h] = std::lerp(values[last], values[lag], share);
    }
    last = lag;
    const auto grown = static_cast<std::size_t>(kLagGrowth * static_cast<double>(lag));
    const std::size_t next = lag < kEveryLag ? lag + 1 : std::max(lag + 1, grown);
    lag = lag + 1 < samples ? std::min(next, samples - 1) : samples;
  }
  return values;
}

double product_at(const std::vector<double>& a, const std::vector<double>& b, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t t = lag; t < a.size(); ++t) sum += a[t] * b[t - lag];
  return sum / static_cast<double>(a.size() - lag);
}

}  // namespace

std::vector<double> squared_correlations(const VectorSeries& series) {
  const std::size_t n = series.front().size();
  double power = 0.0;  // sum of the mean squares
  for (const auto& component : series) power += product_at(component, component, 0);
  const auto d = static_cast<double>(series.size());
  const double unit = power * power / d;
  if (!(unit > 0.0)) return std::vector<double>(n, 1.0);
  std::vector<double> squares = at_all_lags(n, [&](std::size_t lag) {
    double sum = 0.0;
    for (const auto& a : series) sum += std::pow(product_at(a, a, lag), 2);
    return std::min(sum / unit, 1.0);
  });
  squares.front() = 1.0;
  // Mean at lag 0 of the squared correlation between two components that are independent.
  const double by_chance = unit / d / effective_samples(squares);
  const std::vector<double> between = at_all_lags(n, [&](std::size_t lag) {
    const double least =
        kChanceFactor * by_chance * static_cast<double>(n) / static_cast<double>(n - lag);
    double sum = 0.0;
    for (const auto& a : series) {
      for (const auto& b : series) {
        const double square = &a == &b ? 0.0 : std::pow(product_at(a, b, lag), 2);
        sum += square > least ? square : 0.0;
      }
    }
    return sum / unit;
  });
  for (std::size_t lag = 1; lag < n; ++lag) {
    squares[lag] = std::min(squares[lag] + between[lag], 1.0);
  }
  return squares;
}

VectorSeries semivariances(const VectorSeries& series) {
  VectorSeries all;
  for (const auto& component : series) {
    all.push_back(at_all_lags(component.size(), [&](std::size_t lag) {
      double sum = 0.0;
      for (std::size_t t = lag; t < component.size(); ++t) {
        const double step = component[t] - component[t - lag];
        sum += step * step;
      }
      return 0.5 * sum / static_cast<double>(component.size() - lag);
    }));
  }
  return all;
}

double effective_samples(std::span<const double> squared_correlations) {
  const auto n = static_cast<double>(squared_correlations.size());
  double sum = 1.0;
  for (std::size_t lag = 1; lag < squared_correlations.size(); ++lag) {
    const auto h = static_cast<double>(lag);
    sum += 2.0 * (1.0 - h / n) * squared_correlations[lag];
    if (h >= kWindow * sum) break;
  }
  return std::max(n / sum, 1.0);
}

}  // namespace montecarta::analysis
