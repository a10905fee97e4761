// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_setup.hpp"

#include <span>

namespace montecarta::filters {

/// All filters, in the order in which they are listed.
std::span<const FilterKind> filter_kinds();

}  // namespace montecarta::filters
