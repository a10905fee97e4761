// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"
#include "engine/runs/slam_filter.hpp"

#include <cstddef>
#include <span>

namespace montecarta {

/// Mean and covariance of a mixture of Gaussians over the pose (SPEC 19), as differences from one
/// component `of(reference)`: components that are all equal give exactly their own moments,
/// whatever their weights are rounded to.
template <class Of>
PoseMoments mixture_of_moments(std::span<const double> weights, std::size_t reference,
                               const Of& of) {
  const PoseMoments& about = of(reference);
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    shift += weights[i] * boxminus(of(i).mean, about.mean);
  }
  const Pose mean{about.mean.x + shift(0), about.mean.y + shift(1),
                  wrap(about.mean.heading + shift(2))};
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero(), own = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Eigen::Vector3d away = boxminus(of(i).mean, mean);
    spread += weights[i] * (away * away.transpose());
    own += weights[i] * (of(i).covariance - about.covariance);
  }
  own = (about.covariance + own).eval();
  return {mean, own + spread};
}

}  // namespace montecarta
