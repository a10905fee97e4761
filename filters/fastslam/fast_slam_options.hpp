// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/population/population.hpp"

#include <string>
#include <vector>

namespace montecarta {

/// The three ways to weigh a particle of FastSLAM II (SPEC 7.2).
enum class WeightForm {
  closed,  ///< product of N(innovation; S), each before absorbing the detection
  ratio,   ///< likelihood times prior over proposal at the drawn pose
  batch,   ///< N of the stacked innovation, linearised at the predicted pose
};

/// Names of the weight forms, in the order of the enumerators.
const std::vector<std::string>& weight_form_names();
WeightForm weight_form(const FilterOptions& options);

}  // namespace montecarta
