// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace montecarta::filters {

/// Clusters by farthest points (Gonzalez 1985), at most twice as wide as the narrowest there are:
/// every new centre is the point farthest from those before it.
template <std::size_t D>
class FarthestPoints {
 public:
  using Place = std::array<double, D>;

  explicit FarthestPoints(std::span<const Place> points)
      : points_(points),
        owners_(points.size(), 0),
        distances_(points.size(), std::numeric_limits<double>::infinity()) {}

  /// Adds a centre; false where all points are centres already.
  bool grow() {
    if (centres_.size() == points_.size()) return false;
    const auto farthest = std::max_element(distances_.begin(), distances_.end());
    add(static_cast<std::uint32_t>(farthest - distances_.begin()));
    return true;
  }
  /// Back to the first `count` centres.
  void shrink(std::size_t count) {
    const std::vector<std::uint32_t> kept(centres_.begin(),
                                          centres_.begin() + static_cast<std::ptrdiff_t>(count));
    centres_.clear();
    std::fill(distances_.begin(), distances_.end(), std::numeric_limits<double>::infinity());
    for (const std::uint32_t centre : kept) add(centre);
  }

  std::span<const std::uint32_t> centres() const { return centres_; }
  /// {point} the number of its centre.
  std::span<const std::uint32_t> owners() const { return owners_; }
  /// No point is farther from its centre.
  double radius() const {
    return std::sqrt(*std::max_element(distances_.begin(), distances_.end()));
  }

 private:
  void add(std::uint32_t centre) {
    const auto number = static_cast<std::uint32_t>(centres_.size());
    centres_.push_back(centre);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      double squared = 0.0;
      for (std::size_t d = 0; d < D; ++d) {
        const double off = points_[i][d] - points_[centre][d];
        squared += off * off;
      }
      if (squared < distances_[i]) distances_[i] = squared, owners_[i] = number;
    }
    distances_[centre] = 0.0, owners_[centre] = number;
  }

  std::span<const Place> points_;
  std::vector<std::uint32_t> centres_;
  std::vector<std::uint32_t> owners_;
  std::vector<double> distances_;  ///< squared, to the nearest centre
};

}  // namespace montecarta::filters
