// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/cell_spec.hpp"
#include "experiments/study/settings.hpp"

#include <cstdint>
#include <optional>
#include <span>

namespace montecarta::experiments {

/// Number of scans from one fix of the position to the next; 0 if there are none. Throws StudyError
/// if it is no whole number.
std::uint32_t scans_per_fix(const Settings& settings);

/// [m] Deviation of a fix that the filters assume; nullopt if there are none.
std::optional<double> believed_sigma_fix(const Settings& settings);

/// Throws StudyError if there are fixes of the position but a filter cannot use them. The error
/// suggests those of `filters` that can.
void refuse_fixes(const Settings& settings, std::span<const CellSpec> cells,
                  std::span<const FilterKind> filters);

}  // namespace montecarta::experiments
