// SPDX-License-Identifier: BSD-3-Clause
#include "filters/setup/filter_setup.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"

#include <charconv>

namespace montecarta::filters {

const std::string& FilterOptions::choice(std::string_view name) const {
  const auto found = values_.find(name);
  const std::string missing =
      formatted("a filter asks for the option '{}', which its FilterKind does not list", name);
  expect(found != values_.end(), missing.c_str());
  return found->second;
}

double FilterOptions::number(std::string_view name) const {
  const std::string& text = choice(name);
  double value = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::size_t FilterOptions::integer(std::string_view name) const {
  return static_cast<std::size_t>(std::stoull(choice(name)));
}

}  // namespace montecarta::filters
