// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_setup.hpp"

#include <span>

namespace montecarta::filters {

/// All filters, in the order in which they are listed. Throws StudyError where two that were added
/// have one name.
std::span<const FilterKind> filter_kinds();

/// Those of them that add_filter() added.
std::span<const FilterKind> added_filter_kinds();

/// Adds a filter of another source tree; before main(), by a static variable that its answer, true,
/// is put into. `make` is called later, when all static variables have their values.
bool add_filter(FilterKind (*make)());

}  // namespace montecarta::filters
