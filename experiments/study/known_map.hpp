// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/drives/drives_in_known_map.hpp"
#include "experiments/study/cell_spec.hpp"
#include "experiments/study/settings.hpp"

#include <cstddef>
#include <span>
#include <string>

namespace montecarta::experiments {

/// Returns whether the filters are given the map (belief.map = known).
bool map_is_known(const Settings& settings);
/// Returns whether the filters are given the map and assume that it has no errors.
bool map_is_exact(const Settings& settings);
/// Deviations of what the filters know at the start, of the section `in`: the true ones or those
/// that the filters assume. A recorded drive has no true ones.
PriorDeviations prior_deviations_of(const Settings& settings, const std::string& in);

/// Throws StudyError if the map is known but a filter cannot use it or the drive does not have it,
/// or if the map is not known but the start or the map has a deviation. The error suggests one of
/// `filters`. `landmarks` is the number of known positions.
void refuse_known_map(const Settings& settings, std::span<const CellSpec> cells,
                      std::span<const FilterKind> filters, std::size_t landmarks);

}  // namespace montecarta::experiments
