// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/path_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace montecarta::analysis {
namespace {

/// Where points lie: (x, y) in columns `x` and `x` + 1 of data whose name begins with `name`.
void include(const std::vector<FigureData>& all, const std::string& name, std::size_t x,
             Bounds& bounds) {
  for (const FigureData& data : all) {
    if (!data.name.starts_with(name)) continue;
    for (const auto& row : data.rows) bounds.include(row[x], row[x + 1]);
  }
}

/// Without the few fixes that lie far from all others.
Bounds bounds_of_fixes(const FigureData& fixes) {
  constexpr double kWild = 0.01;
  Bounds bounds;
  std::vector<double> x, y;
  for (const auto& row : fixes.rows) {
    x.push_back(row[1]);
    y.push_back(row[2]);
  }
  if (x.empty()) return bounds;
  std::ranges::sort(x);
  std::ranges::sort(y);
  const auto cut = static_cast<std::size_t>(kWild * static_cast<double>(x.size()));
  bounds.include(x[cut], y[cut]);
  bounds.include(x[x.size() - 1 - cut], y[y.size() - 1 - cut]);
  return bounds;
}

}  // namespace

void Bounds::include(double x, double y) {
  constexpr double kBeyondAnyMap = 1e100;  // [m]
  if (!(std::abs(x) < kBeyondAnyMap && std::abs(y) < kBeyondAnyMap)) return;
  left = std::min(left, x);
  right = std::max(right, x);
  low = std::min(low, y);
  high = std::max(high, y);
}

Bounds Bounds::widened() const {
  const double width = right - left, height = high - low;
  const double room = 0.05 * std::max(width, height) + 1e-3;
  const double x = room + std::max(0.0, 0.25 * height - width) / 2.0;
  const double y = room + std::max(0.0, 0.25 * width - height) / 2.0;
  Bounds wide;
  wide.include(left - x, low - y);
  wide.include(right + x, high + y);
  return wide;
}

Bounds Bounds::grown(double share) const {
  const double room = share * std::max(right - left, high - low);
  Bounds wide;
  wide.include(left - room, low - room);
  wide.include(right + room, high + room);
  return wide;
}

Bounds path_bounds(const std::vector<FigureData>& all) {
  Bounds bounds;
  include(all, "path_", 1, bounds);
  include(all, "path_", 3, bounds);
  include(all, "landmarks.csv", 0, bounds);
  return bounds.widened();
}

Bounds recorded_bounds(const std::vector<FigureData>& all, const FigureData& fixes,
                       const FigureData& landmarks) {
  Bounds bounds = bounds_of_fixes(fixes);
  const Bounds limit = bounds.grown(0.25);
  const bool limited = !bounds.empty();
  for (const FigureData& data : all) {
    const std::size_t x = data.name.starts_with("path_") ? 1 : 0;
    if (x == 0 && !data.name.starts_with("map_")) continue;
    for (const auto& row : data.rows) {
      if (!limited || limit.contains(row[x], row[x + 1])) bounds.include(row[x], row[x + 1]);
    }
  }
  include({landmarks}, "landmarks.csv", 0, bounds);
  return bounds.widened();
}

}  // namespace montecarta::analysis
