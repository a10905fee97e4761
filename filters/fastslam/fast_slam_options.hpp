// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/resampling.hpp"
#include "filters/setup/filter_setup.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace montecarta {

/// What every filter of the family can be told.
struct FastSlamSettings {
  std::size_t particles = 100;
  Resampling resampling = Resampling::systematic;
  double resample_below = 0.5;  ///< resample where ESS < this times particles (EQUATIONS 18)
};

/// The three ways to weigh a particle of FastSLAM II (EQUATIONS 6).
enum class WeightForm {
  closed,  ///< product of N(innovation; S), each before absorbing the detection
  ratio,   ///< likelihood times prior over proposal at the drawn pose
  batch,   ///< N of the stacked innovation, linearised at the predicted pose
};

/// The options that the whole family shares, in the order in which they are documented.
std::vector<Option> fast_slam_options();
/// Reads them.
FastSlamSettings fast_slam_settings(const FilterOptions& options);
/// Names of the weight forms, in the order of the enumerators.
const std::vector<std::string>& weight_form_names();
WeightForm weight_form(const FilterOptions& options);

}  // namespace montecarta
