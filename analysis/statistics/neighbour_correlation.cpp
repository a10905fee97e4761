// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/neighbour_correlation.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kLeastHalfWindow = 25;
constexpr double kMostCorrelation = 1.0 - 1e-6;

/// Sums of squared and mixed deviations.
struct Deviations {
  double xx = 0.0, yy = 0.0, xy = 0.0;
};

Deviations operator+(const Deviations& a, const Deviations& b) {
  return {a.xx + b.xx, a.yy + b.yy, a.xy + b.xy};
}

double correlation(const Deviations& above, const Deviations& below) {
  const double scale = std::sqrt((above.xx - below.xx) * (above.yy - below.yy));
  const double r = (above.xy - below.xy) / scale;
  return r > 0.0 ? std::min(r, kMostCorrelation) : 0.0;  // also where r is not a number
}

}  // namespace

void NeighbourCorrelation::add(std::span<const double> values, double cap) {
  for (std::size_t s = 0; s < pairs_.size(); ++s) {
    const double x = std::min(values[s], cap), y = std::min(values[s + 1], cap);
    if (std::isnan(values[s]) || std::isnan(values[s + 1])) continue;
    Pair& pair = pairs_[s];
    pair.n += 1.0;
    pair.x += x;
    pair.y += y;
    pair.xx += x * x;
    pair.yy += y * y;
    pair.xy += x * y;
  }
}

std::vector<double> NeighbourCorrelation::result() const {
  std::vector<Deviations> up_to(pairs_.size() + 1);
  for (std::size_t s = 0; s < pairs_.size(); ++s) {
    const Pair& p = pairs_[s];
    Deviations here;
    if (p.n > 0.0) here = {p.xx - p.x * p.x / p.n, p.yy - p.y * p.y / p.n, p.xy - p.x * p.y / p.n};
    up_to[s + 1] = up_to[s] + here;
  }
  const std::size_t half = std::max(kLeastHalfWindow, pairs_.size() / 8);
  std::vector<double> correlations;
  for (std::size_t s = 0; s < pairs_.size(); ++s) {
    const std::size_t first = s > half ? s - half : 0;
    const std::size_t last = std::min(pairs_.size(), s + half + 1);
    correlations.push_back(correlation(up_to[last], up_to[first]));
  }
  return correlations;
}

}  // namespace montecarta::analysis
