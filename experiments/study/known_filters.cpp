// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/known_filters.hpp"

#include "experiments/external/external_filter.hpp"
#include "filters/factory.hpp"

#include <vector>

namespace montecarta::experiments {

std::span<const FilterKind> known_filters() {
  static const std::vector<FilterKind> kinds = [] {
    std::vector<FilterKind> all(filter_kinds().begin(), filter_kinds().end());
    all.push_back(external_kind());
    return all;
  }();
  return kinds;
}

}  // namespace montecarta::experiments
