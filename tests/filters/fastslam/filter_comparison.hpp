// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/factory.hpp"
#include "tests/filters/same_runs.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <ostream>
#include <string>

/// A filter of the family in one setting, and how it is made.
namespace montecarta::filters {

struct Variant {
  std::string filter;
  std::string weights = "closed";
  Association association = Association::known;
  std::size_t particles = 13;  ///< not a multiple of the lanes
  std::map<std::string, std::string, std::less<>> options = {};

  friend std::ostream& operator<<(std::ostream& out, const Variant& v) {
    out << v.filter << '_' << v.weights
        << (v.association == Association::known ? "_known_" : "_nearest_") << v.particles;
    for (const auto& [name, value] : v.options) {
      out << '_' << name << '_';
      for (const char letter : value) out << (letter == '.' ? 'p' : letter);  // a test's name
    }
    return out;
  }
};

inline const FilterKind& kind_of(const Variant& v) {
  const auto kinds = filter_kinds();
  return *std::find_if(kinds.begin(), kinds.end(),
                       [&](const FilterKind& kind) { return kind.name == v.filter; });
}

inline FilterSetup setup_of(const Variant& v, const SmallWorldSettings& world) {
  auto values = v.options;
  for (const Parameter& option : kind_of(v).options) {
    values.try_emplace(option.key, *option.fallback);
  }
  values["particles"] = std::to_string(v.particles);
  if (values.contains("weights")) values["weights"] = v.weights;
  return {.belief = world.noise,
          .association = {.kind = v.association},
          .options = FilterOptions(values),
          .landmarks = world.landmarks};
}

/// The filter that users get, over lanes.
inline std::unique_ptr<SlamFilter> make_production(const Variant& v,
                                                   const SmallWorldSettings& world) {
  return kind_of(v).make(setup_of(v, world));
}

/// The textbook version.
inline std::unique_ptr<SlamFilter> make_plain(const Variant& v, const SmallWorldSettings& world) {
  return kind_of({"plain_" + v.filter}).make(setup_of(v, world));
}

}  // namespace montecarta::filters
