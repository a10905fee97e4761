// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"
#include "filters/models/parameter.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::filters {

/// Values of a filter's options, checked against their Parameter beforehand.
class FilterOptions {
 public:
  explicit FilterOptions(std::map<std::string, std::string, std::less<>> values)
      : values_(std::move(values)) {}
  double number(std::string_view name) const;
  std::size_t integer(std::string_view name) const;
  const std::string& choice(std::string_view name) const;

 private:
  std::map<std::string, std::string, std::less<>> values_;
};

/// The enumerator at the place of `choice` among `choices`, which stand in the enumerators' order
/// and hold it: an option's value was checked before.
template <class Enumerator>
Enumerator chosen(const std::string& choice, const std::vector<std::string>& choices) {
  return static_cast<Enumerator>(std::find(choices.begin(), choices.end(), choice) -
                                 choices.begin());
}

}  // namespace montecarta::filters
