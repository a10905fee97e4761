// SPDX-License-Identifier: BSD-3-Clause
// A filter outside the source tree of montecarta: dead reckoning by another name.
#include "filters/dead_reckoning.hpp"
#include "filters/factory.hpp"

namespace {

montecarta::filters::FilterKind my_filter_kind() {
  montecarta::filters::FilterKind kind = montecarta::filters::dead_reckoning_kind();
  kind.name = "my_filter";
  kind.long_name = "a filter of my own";
  return kind;
}

const bool kAdded = montecarta::filters::add_filter(my_filter_kind);

}  // namespace
