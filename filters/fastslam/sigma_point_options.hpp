// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/fast_slam_options.hpp"
#include "filters/moments/moment_transforms.hpp"

#include <vector>

namespace montecarta {

/// What every filter of the family with sigma points can be told: the family's options and the form
/// of the weight, closed or ratio.
std::vector<Option> sigma_point_options();

/// Whether the landmark's covariance is part of the pose's innovation (EQUATIONS 7).
Option map_uncertainty_option();
MapUncertainty map_uncertainty(const FilterOptions& options);

/// Interval and weights of central differences (EQUATIONS 3).
std::vector<Option> central_difference_options();
/// Central differences for every stage; `map_uncertainty` matters to the pose alone.
SigmaPoints central_difference_points(const FilterSetup& setup, MapUncertainty map_uncertainty);

}  // namespace montecarta
