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

/// Definition of the error that the covariance of an imported pose describes (STATISTICS 19).
struct StoredConvention {
  const char* name;     ///< name that users type
  const char* column;   ///< name of the column of the NEES under this convention
  const char* meaning;  ///< description of that column
};

/// All conventions, in the order of files and tables.
inline constexpr std::array kErrorConventions = {
    StoredConvention{"world", "nees_world",
                     "imported: NEES if the covariance were of the error world"},
    StoredConvention{"body", "nees_body",
                     "imported: NEES if the covariance were of the error body"},
    StoredConvention{"right-invariant", "nees_right_invariant",
                     "imported: NEES if the covariance were of the error right-invariant"},
    StoredConvention{"left-invariant", "nees_left_invariant",
                     "imported: NEES if the covariance were of the error left-invariant"},
    StoredConvention{"world-body", "nees_world_body",
                     "imported: NEES if the covariance were of the error world-body"}};

/// The first of them are those of a pose in the plane, where world-body is world.
inline constexpr std::size_t kConventionsInPlane = 4;
/// The first of them are in the files of every version that has any.
inline constexpr std::size_t kFirstConventions = 3;

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
  error_component,  ///< components of an imported error, named in the cell's settings
  error_component_column
};
/// The scans at which joint estimates are stored. The run of `all` scans is divided into `wanted`
/// parts of nearly equal length, and the last scan of each part is chosen.
std::vector<std::uint32_t> joint_scans_of(std::size_t all, std::size_t wanted);

std::string_view name_of(Axis axis);
/// The axis of that name; nullopt if there is none.
std::optional<Axis> axis_named(std::string_view name);

/// One dataset of a cell. The shape is that of one run.
struct Column {
  std::string name;  ///< name in the file, e.g. "pose_mean"
  Element element = Element::f64;
  std::vector<Axis> axes;
  std::vector<std::size_t> shape;  ///< one length per axis; empty = one value per run
  std::string units;  ///< units in UDUNITS style: "m", "rad", "1"; "m, m, rad" if components differ
  std::string long_name;

  std::size_t elements() const;
  std::size_t bytes() const { return elements() * size_of(element); }
};

/// A group of columns that a study selects together (record.columns).
struct ColumnGroup {
  const char* name;
  bool ColumnSelection::*is_chosen;  ///< whether it is stored; nullptr: always
};
/// All groups, in the order of `montecarta list columns`.
std::span<const ColumnGroup> column_groups();

/// One row of the table of all columns except those that filters declare themselves (OwnColumn).
/// The layout of records, the recorder, the checks of a file and `montecarta list columns` are
/// derived from this table.
struct ColumnKind {
  const char* name;
  const char* group;  ///< name of one of column_groups()
  Element element;
  std::vector<Axis> axes;
  const char* units;
  const char* long_name;
  bool (*applies)(const Cell&) = nullptr;  ///< whether a cell has it; nullptr: always
  /// Takes the number from the report of a scan; nullptr if Recorder fills the column otherwise.
  double (*of_report)(const ScanReport&) = nullptr;
};
/// All columns, in the order of the file. The own columns of a filter follow.
std::span<const ColumnKind> column_table();

/// Returns whether a study with `selection` stores the columns of this group.
bool is_selected(std::string_view group, const ColumnSelection& selection);

/// Adds everything that a replay shows to `selection`: covariance, ancestry, particles, map.
ColumnSelection in_full(ColumnSelection selection);

/// Lengths of the axes of a cell's columns.
struct AxisLengths {
  std::size_t time = 0, scan = 0, joint = 0, particle = 0;
  std::optional<std::size_t> landmark;  ///< number of landmarks; nullopt if unknown
  /// Number of components of the error; nullopt if unknown.
  std::optional<std::size_t> error_component;
};
/// Length of an axis; nullopt if it depends on the landmarks or the error, and those are not known.
std::optional<std::size_t> length_of(Axis axis, const AxisLengths& lengths);

}  // namespace montecarta::engine
