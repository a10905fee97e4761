// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/columns.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>

namespace montecarta::engine {
namespace {

/// In the order of Axis.
constexpr std::array<std::string_view, 13> kAxisNames = {"time",
                                                         "scan",
                                                         "particle",
                                                         "landmark",
                                                         "component",
                                                         "component_column",
                                                         "coordinate",
                                                         "coordinate_column",
                                                         "joint",
                                                         "state",
                                                         "state_column",
                                                         "error_component",
                                                         "error_component_column"};
static_assert(kAxisNames.size() == static_cast<std::size_t>(Axis::error_component_column) + 1);

}  // namespace

std::size_t size_of(Element element) {
  switch (element) {
    case Element::u8:
      return 1;
    case Element::u16:
      return 2;
    case Element::u32:
      return 4;
    case Element::f64:
    case Element::u64:
      return 8;
  }
  expect(false, "an element of unknown type");
  return 0;
}

std::vector<std::uint32_t> joint_scans_of(std::size_t all, std::size_t wanted) {
  const std::size_t count = std::min(all, wanted);
  std::vector<std::uint32_t> scans(count);
  for (std::size_t k = 0; k < count; ++k) {
    scans[k] = static_cast<std::uint32_t>((k + 1) * all / count - 1);
  }
  return scans;
}

std::string_view name_of(Axis axis) { return kAxisNames[static_cast<std::size_t>(axis)]; }

std::optional<Axis> axis_named(std::string_view name) {
  const auto found = std::ranges::find(kAxisNames, name);
  if (found == kAxisNames.end()) return std::nullopt;
  return static_cast<Axis>(found - kAxisNames.begin());
}

std::size_t Column::elements() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

}  // namespace montecarta::engine
