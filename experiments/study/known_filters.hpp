// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_kind.hpp"

#include <span>

namespace montecarta::experiments {

/// All filters that a study may name: those of the filter table, then `external`.
std::span<const FilterKind> known_filters();

}  // namespace montecarta::experiments
