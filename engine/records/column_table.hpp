// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/core/slam_filter.hpp"
#include "engine/records/columns.hpp"

#include <optional>
#include <span>
#include <vector>

namespace montecarta::engine {

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

/// How long the axes of a cell's columns are.
struct AxisLengths {
  std::size_t time = 0, scan = 0, joint = 0, particle = 0;
  std::optional<std::size_t> landmark;         ///< nullopt: not known
  std::optional<std::size_t> error_component;  ///< likewise
};
/// nullopt where that of the landmarks or of the error decides, which is not known.
std::optional<std::size_t> length_of(Axis axis, const AxisLengths& lengths);

}  // namespace montecarta::engine
