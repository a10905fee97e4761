// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "tests/filters/reference/particle.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::filters::reference {

/// Moments of sum_i w_i N(mean(i), covariance(i)), headings as differences from the heaviest
/// particle (EQUATIONS 19). `Weighed`: whatever has a log_weight.
template <class Weighed, class Mean, class Covariance>
PoseMoments mixture_moments(const std::vector<Weighed>& particles, const Mean& mean,
                            const Covariance& covariance) {
  const auto heaviest = std::max_element(
      particles.begin(), particles.end(),
      [](const Weighed& a, const Weighed& b) { return a.log_weight < b.log_weight; });
  const Pose reference = as_pose(mean(*heaviest));
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (const Weighed& p : particles) {
    shift += std::exp(p.log_weight) * boxminus(as_pose(mean(p)), reference);
  }
  PoseMoments moments;
  moments.mean = {reference.x + shift(0), reference.y + shift(1),
                  wrap(reference.heading + shift(2))};
  for (const Weighed& p : particles) {
    const Eigen::Vector3d e = boxminus(as_pose(mean(p)), moments.mean);
    moments.covariance += std::exp(p.log_weight) * (covariance(p) + e * e.transpose());
  }
  return moments;
}

}  // namespace montecarta::filters::reference
