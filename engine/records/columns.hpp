// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/core/slam_filter.hpp"
#include "engine/namespaces.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::engine {

/// What error the covariance of an imported pose may be the covariance of (STATISTICS 19).
struct StoredConvention {
  const char* name;     ///< as users type it
  const char* column;   ///< of the NEES by it
  const char* meaning;  ///< of that column
};

/// All of them, in the order of files and tables.
inline constexpr std::array kErrorConventions = {
    StoredConvention{"world", "nees_world",
                     "imported: NEES if the covariance were of the error world"},
    StoredConvention{"body", "nees_body",
                     "imported: NEES if the covariance were of the error body"},
    StoredConvention{"right-invariant", "nees_right_invariant",
                     "imported: NEES if the covariance were of the error right-invariant"}};

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

/// A group of columns that a study chooses together (record.columns).
struct ColumnGroup {
  const char* name;
  bool ColumnSelection::*is_chosen;  ///< nullptr: always stored
};
/// In the order of `montecarta list columns`.
std::span<const ColumnGroup> column_groups();

/// One row of the table of all columns, from which the layout of a record, what is recorded, what
/// is checked in a file and `montecarta list columns` follow.
struct ColumnKind {
  const char* name;
  const char* group;  ///< of column_groups()
  Element element;
  std::vector<Axis> axes;
  const char* units;
  const char* long_name;
  bool (*applies)(const Cell&) = nullptr;  ///< which cells have it; nullptr: all
  /// Of a number of every scan that a filter reports; others are filled by Recorder.
  double (*of_report)(const ScanReport&) = nullptr;
};
/// In the order of the file.
std::span<const ColumnKind> column_table();

/// Whether a study that chooses `selection` stores it.
bool is_selected(const ColumnKind& kind, const ColumnSelection& selection);

/// `selection` and all that a replay needs: covariance, ancestry, particles and the map.
ColumnSelection in_full(ColumnSelection selection);

/// How long the axes of a cell's columns are.
struct AxisLengths {
  std::size_t time = 0, scan = 0, joint = 0, particle = 0;
  std::optional<std::size_t> landmark;         ///< nullopt: not known
  std::optional<std::size_t> error_component;  ///< likewise
};
/// nullopt where that of the landmarks or of the error decides, which is not known.
std::optional<std::size_t> length_of(Axis axis, const AxisLengths& lengths);

}  // namespace montecarta::engine
