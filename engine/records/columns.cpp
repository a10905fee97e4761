// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/columns.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace montecarta {

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

std::string_view name_of(Axis axis) {
  switch (axis) {
    case Axis::time:
      return "time";
    case Axis::scan:
      return "scan";
    case Axis::particle:
      return "particle";
    case Axis::landmark:
      return "landmark";
    case Axis::component:
      return "component";
    case Axis::component_column:
      return "component_column";
    case Axis::coordinate:
      return "coordinate";
    case Axis::coordinate_column:
      return "coordinate_column";
    case Axis::joint:
      return "joint";
    case Axis::state:
      return "state";
    case Axis::state_column:
      return "state_column";
  }
  expect(false, "an axis without a name");
  return {};
}

std::optional<Axis> axis_named(std::string_view name) {
  using enum Axis;
  for (Axis axis : {time, scan, particle, landmark, component, component_column, coordinate,
                    coordinate_column, joint, state, state_column}) {
    if (name_of(axis) == name) return axis;
  }
  return std::nullopt;
}

std::size_t Column::elements() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

}  // namespace montecarta
