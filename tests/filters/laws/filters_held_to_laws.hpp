// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/factory.hpp"

#include <ostream>
#include <vector>

namespace montecarta::filters {

/// So that a test is listed by the filter's name.
inline void PrintTo(const FilterKind& kind, std::ostream* out) { *out << kind.name; }

/// The filters that another source tree added, where it added any; else all that are shipped.
inline std::vector<FilterKind> filters_held_to_laws() {
  const auto added = added_filter_kinds();
  const auto kinds = added.empty() ? filter_kinds() : added;
  return {kinds.begin(), kinds.end()};
}

}  // namespace montecarta::filters
