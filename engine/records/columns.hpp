// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::engine {

enum class Element : std::uint8_t { f64, u8, u16, u32, u64 };
std::size_t size_of(Element element);

/// Axes behind the first one, which is always `run`.
enum class Axis : std::uint8_t {
  time,
  scan,
  particle,
  landmark,
  component,
  component_column,
  coordinate,
  coordinate_column,
  joint,  ///< the scans of joint_scans_of()
  state,  ///< x, y, heading, then x and y of each landmark
  state_column,
  error_component,  ///< of an imported estimate's error, as the cell's settings name them
  error_component_column
};
/// The scans of `all` at which joint estimates are stored: the last of each of `wanted` parts, as
/// equal as can be, of the run.
std::vector<std::uint32_t> joint_scans_of(std::size_t all, std::size_t wanted);

std::string_view name_of(Axis axis);
/// The axis of that name; nullopt where there is none.
std::optional<Axis> axis_named(std::string_view name);

/// One dataset of a cell; the shape is that of one run.
struct Column {
  std::string name;  ///< as in the file, e.g. "pose_mean"
  Element element = Element::f64;
  std::vector<Axis> axes;
  std::vector<std::size_t> shape;  ///< as many as axes; empty = one value a run
  std::string units;  ///< UDUNITS style: "m", "rad", "1"; "m, m, rad" where components differ
  std::string long_name;

  std::size_t elements() const;
  std::size_t bytes() const { return elements() * size_of(element); }
};

}  // namespace montecarta::engine
