// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"

#include <Eigen/Core>

#include <cmath>
#include <optional>

namespace montecarta::filters {

/// Lower Cholesky factor L of an innovation covariance S = L L' over (range, bearing).
struct InnovationFactor {
  double l00, l10, l11;

  double log_det() const { return 2.0 * std::log(l00 * l11); }
  Eigen::Matrix2d covariance() const {
    return Eigen::Matrix2d{{l00 * l00, l00 * l10}, {l00 * l10, l10 * l10 + l11 * l11}};
  }
  /// L^-1 v; its squared norm is D^2.
  Eigen::Vector2d whiten(const Eigen::Vector2d& v) const {
    const double first = v(0) / l00;
    return {first, (v(1) - l10 * first) / l11};
  }
};

/// Nothing where S is not positive definite or not a number.
[[nodiscard]] inline std::optional<InnovationFactor> factor(const Eigen::Matrix2d& S) {
  if (!(S(0, 0) > 0.0)) return std::nullopt;
  const double l00 = std::sqrt(S(0, 0));
  const double l10 = S(1, 0) / l00;
  const double pivot = S(1, 1) - l10 * l10;
  if (!(pivot > 0.0)) return std::nullopt;
  return InnovationFactor{l00, l10, std::sqrt(pivot)};
}

/// log N(v; S) of a two-dimensional innovation with squared norm D^2 (EQUATIONS (0.1)).
inline double log_normal_density(double squared_distance, const InnovationFactor& L) {
  return -0.5 * (squared_distance + L.log_det()) - std::log(kTwoPi);
}

}  // namespace montecarta::filters
