// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_kind.hpp"

#include <span>

namespace montecarta::filters {

/// All filters, in the order of the documentation. Throws StudyError if two added filters have the
/// same name.
std::span<const FilterKind> filter_kinds();

/// The filters that add_filter() added.
std::span<const FilterKind> added_filter_kinds();

/// Adds a filter from another source tree. It must be called before main(), as the initialiser of a
/// static variable, and returns true. `make` is called when all static variables are initialised.
bool add_filter(FilterKind (*make)());

}  // namespace montecarta::filters
