// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/factory.hpp"

#include <functional>
#include <map>
#include <string>

namespace montecarta::filters {

/// A filter's options as a newcomer gets them, but for those of `others`.
inline FilterOptions default_options(
    const FilterKind& kind, const std::map<std::string, std::string, std::less<>>& others = {}) {
  std::map<std::string, std::string, std::less<>> values = others;
  for (const Option& option : kind.options) values.emplace(option.key, *option.fallback);
  return FilterOptions(values);
}

}  // namespace montecarta::filters
