// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/joint/map_moments.hpp"
#include "filters/setup/filter_options.hpp"

#include <Eigen/Core>

namespace montecarta::filters {

/// Which mean and covariance a joint Gaussian reports (option `moments`).
enum class Moments {
  map,    ///< its own, in map coordinates
  pushed  ///< those in map coordinates of a Gaussian in the right-invariant chart (EQUATIONS 19)
};

/// The option `moments` of a filter, `map` by default, and what a user chose.
Option moments_option(const char* fallback);
Moments moments_of(const FilterOptions& options);

/// Rows x, y, heading [m, m, rad], then x and y of any number of landmarks [m]: takes `mean` and
/// `covariance` for those of the right-invariant error about the estimate, truth = exp(error)
/// estimate, and replaces them by the mean and covariance that follow for the rows themselves. All
/// points turn with the heading, which alone is not linear. NaN of landmarks never seen stays NaN.
void push_moments(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance);

/// The same of a pose, and of a point of a map whose heading has that variance [rad^2].
PoseMoments pushed(const PoseMoments& pose);
LandmarkEstimate pushed(const PointMoments& point, double heading_variance);

}  // namespace montecarta::filters
