// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/resampling.hpp"
#include "filters/setup/filter_setup.hpp"

#include <string>
#include <vector>

namespace montecarta {

/// How many particles, and how and when they are resampled (EQUATIONS 18): `particles`,
/// `resampling`, `resample_below`, in the order in which they are documented.
std::vector<Option> resampling_options(const std::string& particles);
/// Reads `resampling`.
Resampling chosen_resampling(const FilterOptions& options);

}  // namespace montecarta
