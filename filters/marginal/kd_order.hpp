// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace montecarta::filters {

using Point3 = std::array<double, 3>;

/// The dimension in which the points lie farthest apart.
inline std::size_t widest_dimension(std::span<const Point3> points,
                                    std::span<const std::uint32_t> of) {
  std::size_t widest = 0;
  double most = -1.0;
  for (std::size_t d = 0; d < 3; ++d) {
    double low = points[of[0]][d], high = low;
    for (const std::uint32_t i : of) {
      low = std::min(low, points[i][d]);
      high = std::max(high, points[i][d]);
    }
    if (high - low > most) most = high - low, widest = d;
  }
  return widest;
}

/// Rearranges `order` so that any `leaf` consecutive points from a multiple of `leaf` on lie near
/// each other: halves at the median of the widest dimension, halves cut at multiples of `leaf`.
inline void split_in_kd_order(std::span<const Point3> points, std::span<std::uint32_t> order,
                              std::size_t leaf) {
  if (order.size() <= leaf) return;
  const std::size_t leaves = (order.size() + leaf - 1) / leaf;
  const std::size_t half = leaves / 2 * leaf;
  const std::size_t d = widest_dimension(points, order);
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return points[a][d] != points[b][d] ? points[a][d] < points[b][d] : a < b;
                   });
  split_in_kd_order(points, order.first(half), leaf);
  split_in_kd_order(points, order.subspan(half), leaf);
}

/// The numbers of all points, those of a leaf together.
inline void kd_order(std::span<const Point3> points, std::size_t leaf,
                     std::vector<std::uint32_t>& order) {
  order.resize(points.size());
  std::iota(order.begin(), order.end(), 0U);
  split_in_kd_order(points, order, leaf);
}

}  // namespace montecarta::filters
