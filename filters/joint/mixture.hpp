// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"
#include "engine/runs/slam_filter.hpp"

#include <cstddef>
#include <span>

namespace montecarta {

// Moments of mixtures, as differences from one component `of(reference)`: components that are all
// equal give exactly their own moments, whatever their weights are rounded to.

/// Mean of the components' means; headings as differences from the reference's (SPEC 19).
template <class Of>
Pose mixture_mean(std::span<const double> weights, std::size_t reference, const Of& of) {
  const Pose about = of(reference).mean;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < weights.size(); ++i)
    shift += weights[i] * boxminus(of(i).mean, about);
  return {about.x + shift(0), about.y + shift(1), wrap(about.heading + shift(2))};
}

/// Covariance of the components' means about `mean`.
template <class Of>
PoseMoments mixture_spread(std::span<const double> weights, const Pose& mean, const Of& of) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Eigen::Vector3d away = boxminus(of(i).mean, mean);
    spread += weights[i] * (away * away.transpose());
  }
  return {mean, spread};
}

/// Mean of the components' covariances, of any size.
template <class Covariance, class Of>
Covariance mixture_covariance(std::span<const double> weights, std::size_t reference,
                              const Of& of) {
  const Covariance about = of(reference);
  Covariance shift = Covariance::Zero();
  for (std::size_t i = 0; i < weights.size(); ++i) shift += weights[i] * (of(i) - about);
  return about + shift;
}

}  // namespace montecarta
