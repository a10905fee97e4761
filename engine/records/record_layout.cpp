// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/record_layout.hpp"

#include "engine/records/column_table.hpp"

#include <algorithm>
#include <utility>

namespace montecarta::engine {
namespace {

constexpr std::size_t kAlignment = 64;  // a cache line, so that no two columns share one

constexpr std::size_t kMostOfU16 = 65535;  // particles whose indices need no more

/// Without a shape.
Column column_of(const ColumnKind& kind, const Cell& cell) {
  Column column{kind.name, kind.element, kind.axes, {}, kind.units, kind.long_name};
  if (kind.element == Element::u16 && cell.particles > kMostOfU16) column.element = Element::u32;
  return column;
}

}  // namespace

RecordLayout::RecordLayout(const Cell& cell, const ColumnSelection& selection,
                           const Itinerary& itinerary)
    : scans_only_(selection.scans_only),
      scans_(itinerary.scans()),
      particles_(cell.particles),
      landmarks_(cell.landmarks) {
  if (selection.joint && cell.joint) joint_scans_ = joint_scans_of(scans_, selection.joint_scans);
  const AxisLengths lengths{.time = scans_only_ ? scans_ : itinerary.steps(),
                            .scan = scans_,
                            .joint = joint_scans_.size(),
                            .particle = cell.particles,
                            .landmark = cell.landmarks,
                            .error_component = cell.error_components};
  for (const ColumnKind& kind : column_table()) {
    if (!is_selected(kind, selection) || (kind.applies != nullptr && !kind.applies(cell))) continue;
    if (kind.axes.front() == Axis::joint && joint_scans_.empty()) continue;
    Column column = column_of(kind, cell);
    for (const Axis axis : column.axes) column.shape.push_back(*length_of(axis, lengths));
    offsets_.push_back(bytes_);
    bytes_ += (column.bytes() + kAlignment - 1) / kAlignment * kAlignment;
    columns_.push_back(std::move(column));
  }
}

std::optional<std::size_t> RecordLayout::find(std::string_view name) const {
  const auto found = std::find_if(columns_.begin(), columns_.end(),
                                  [&](const Column& column) { return column.name == name; });
  if (found == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns_.begin());
}

}  // namespace montecarta::engine
