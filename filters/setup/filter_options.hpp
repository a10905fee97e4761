// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta {

/// One setting of a filter, as a user types it behind the filter's name in a cell line.
struct FilterOption {
  enum class Kind { number, integer, choice };
  std::string name;
  Kind kind = Kind::number;
  std::string fallback;  ///< default value, as text
  double least = 0.0;    ///< of numbers and integers, inclusive
  double most = 0.0;
  std::vector<std::string> choices;  ///< of Kind::choice
  std::string meaning;               ///< one line, with unit and equation
};

/// Values of a filter's options, checked against their FilterOption beforehand.
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

}  // namespace montecarta
