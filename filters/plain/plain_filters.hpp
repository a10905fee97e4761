// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_kind.hpp"

#include <span>
#include <vector>

namespace montecarta::filters {

/// The textbook versions of the filters in `fast`, named plain_ and then like the fast one. They
/// take the options of the fast filter, except those that their algorithm does not have.
std::vector<FilterKind> plain_kinds(std::span<const FilterKind> fast);

}  // namespace montecarta::filters
