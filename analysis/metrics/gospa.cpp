// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/gospa.hpp"

#include "analysis/metrics/assignment.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

using PointSpan = std::span<const Eigen::Vector2d>;

/// Squared distances, at most the cutoff's: no worse than to leave both alone.
Eigen::MatrixXd costs(PointSpan few, PointSpan many, double cutoff) {
  Eigen::MatrixXd cost(few.size(), many.size());
  for (Eigen::Index i = 0; i < cost.rows(); ++i) {
    for (Eigen::Index j = 0; j < cost.cols(); ++j) {
      const double squared =
          (few[static_cast<std::size_t>(i)] - many[static_cast<std::size_t>(j)]).squaredNorm();
      cost(i, j) = squared < cutoff * cutoff ? squared : cutoff * cutoff;  // NaN is far
    }
  }
  return cost;
}

}  // namespace

Gospa gospa(PointSpan map, PointSpan truth, double cutoff) {
  const bool smaller = map.size() <= truth.size();
  const Eigen::MatrixXd cost = smaller ? costs(map, truth, cutoff) : costs(truth, map, cutoff);
  const std::vector<std::size_t> partner = cheapest_assignment(cost);
  const double far = cutoff * cutoff;
  double squares = 0.0, pairs = 0.0;
  for (std::size_t i = 0; i < partner.size(); ++i) {
    const double squared =
        cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(partner[i]));
    if (squared >= far) continue;
    squares += squared;
    pairs += 1.0;
  }
  Gospa result;
  result.localisation = std::sqrt(squares);
  result.missed = static_cast<double>(truth.size()) - pairs;
  result.spurious = static_cast<double>(map.size()) - pairs;
  result.distance = std::sqrt(squares + 0.5 * far * (result.missed + result.spurious));
  return result;
}

}  // namespace montecarta::analysis
