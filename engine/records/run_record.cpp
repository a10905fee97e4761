// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/run_record.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/result_format.hpp"

#include <algorithm>
#include <utility>

namespace montecarta::engine {
namespace {

constexpr std::size_t kAlignment = 64;  // a cache line, so that no two columns share one

constexpr std::size_t kMostOfU16 = 65535;  // largest number of particles with 16-bit indices

/// The column of a kind for this cell, without its shape.
Column column_of(const ColumnKind& kind, const Cell& cell) {
  Column column{kind.name, kind.element, kind.axes, {}, kind.units, kind.long_name};
  if (kind.element == Element::u16 && cell.particles > kMostOfU16) column.element = Element::u32;
  return column;
}

/// Throws StudyError if a column that a filter declares has the name of something else in the group
/// of its cell, or belongs to no group of columns.
void require_new(const OwnColumn& own, const std::vector<std::string>& declared, const Cell& cell) {
  const auto refuse = [&](const std::string& problem) {
    throw StudyError("filter {}: its column {} {} in Capabilities::own_columns", cell.filter,
                     own.name, problem);
  };
  if (std::ranges::count(column_table(), own.name, &ColumnKind::name) > 0 ||
      std::ranges::count(format::kBesideColumns, own.name) > 0 ||
      std::ranges::count(declared, own.name) > 0 || own.name.find('/') != std::string::npos)
    refuse("(there is one already, or it has a slash): give it another name");
  if (std::ranges::count(column_groups(), own.group, &ColumnGroup::name) == 0)
    refuse(formatted(
        "is of the group {} (montecarta list columns has no such group): give it another group",
        own.group));
}

}  // namespace

RecordLayout::RecordLayout(const Cell& cell, const ColumnSelection& selection,
                           const Itinerary& itinerary, Detail detail)
    : scans_only_(selection.scans_only),
      scans_(itinerary.scans()),
      particles_(cell.particles),
      landmarks_(cell.landmarks) {
  for (const OwnColumn& own : cell.reports.own_columns) {
    require_new(own, own_columns_, cell);
    own_columns_.push_back(own.name);
  }
  if (selection.joint && cell.reports.joint)
    joint_scans_ = joint_scans_of(scans_, selection.joint_scans);
  const AxisLengths lengths{.time = scans_only_ ? scans_ : itinerary.steps(),
                            .scan = scans_,
                            .joint = joint_scans_.size(),
                            .particle = cell.particles,
                            .landmark = cell.landmarks,
                            .error_component = cell.imported ? cell.imported->components : 0};
  add_columns(cell, selection, lengths);
  usual_columns_ = columns_.size();
  if (detail == Detail::full) add_columns(cell, in_full(selection), lengths);
}

/// Adds the columns that are not yet present.
void RecordLayout::add_columns(const Cell& cell, const ColumnSelection& selection,
                               const AxisLengths& lengths) {
  for (const ColumnKind& kind : column_table()) {
    if (!is_selected(kind.group, selection) || (kind.applies != nullptr && !kind.applies(cell)))
      continue;
    if (kind.axes.front() == Axis::joint && joint_scans_.empty()) continue;
    add_column(column_of(kind, cell), lengths);
  }
  for (const OwnColumn& own : cell.reports.own_columns) {
    if (!is_selected(own.group, selection)) continue;
    add_column({own.name, Element::f64, {Axis::scan}, {}, own.units, own.long_name}, lengths);
  }
}

/// Adds a column without its shape, if there is none of its name.
void RecordLayout::add_column(Column column, const AxisLengths& lengths) {
  if (find(column.name)) return;
  for (const Axis axis : column.axes) column.shape.push_back(*length_of(axis, lengths));
  offsets_.push_back(bytes_);
  bytes_ += (column.bytes() + kAlignment - 1) / kAlignment * kAlignment;
  columns_.push_back(std::move(column));
}

std::optional<std::size_t> RecordLayout::find(std::string_view name) const {
  const auto found = std::find_if(columns_.begin(), columns_.end(),
                                  [&](const Column& column) { return column.name == name; });
  if (found == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns_.begin());
}

std::vector<RecordLayout> layouts_of(const StudyPlan& plan, Detail detail) {
  std::vector<RecordLayout> layouts;
  for (const Cell& cell : plan.cells)
    layouts.emplace_back(cell, plan.columns, plan.drives->itinerary(), detail);
  return layouts;
}

RunRecord::RunRecord(const RecordLayout& layout)
    : layout_(&layout), own_memory_(layout.bytes()), memory_(own_memory_) {
  clear();
}

RunRecord::RunRecord(const RecordLayout& layout, std::span<std::byte> memory)
    : layout_(&layout), memory_(memory) {
  expect(memory.size() >= layout.bytes(), "a record was lent too little memory");
  clear();
}

void RunRecord::clear() {
  for (std::size_t c = 0; c < layout_->columns().size(); ++c) {
    if (layout_->columns()[c].element == Element::f64) {
      std::ranges::fill(column<double>(c), std::numeric_limits<double>::quiet_NaN());
    } else {
      std::fill_n(memory_.data() + layout_->offset(c), layout_->columns()[c].bytes(), std::byte{0});
    }
  }
  status_ = RunStatus::missing;
  outcome_ = {};
  cpu_seconds_ = std::numeric_limits<double>::quiet_NaN();
}

void RunRecord::mark_complete(double cpu_seconds) {
  status_ = RunStatus::complete;
  outcome_ = {};
  cpu_seconds_ = cpu_seconds;
}

void RunRecord::mark_failed(std::uint32_t step, std::string_view reason, double cpu_seconds) {
  status_ = RunStatus::failed;
  outcome_ = {};
  outcome_.step = step;
  std::size_t length = std::min(reason.size(), kFailureReasonBytes);
  // A UTF-8 character is never cut: its continuation bytes are removed too.
  const auto continues = [&](std::size_t i) {
    return i < reason.size() && (static_cast<unsigned char>(reason[i]) & 0xC0U) == 0x80U;
  };
  while (length > 0 && continues(length)) --length;
  std::copy_n(reason.begin(), length, outcome_.reason.begin());
  cpu_seconds_ = cpu_seconds;
}

std::span<const std::byte> RunRecord::bytes(std::size_t c) const {
  return {memory_.data() + layout_->offset(c), layout_->columns()[c].bytes()};
}

std::uint64_t RunRecord::fingerprint() const {
  Fingerprint fingerprint;
  for (std::size_t c = 0; c < layout_->usual_columns(); ++c) fingerprint.add(bytes(c));
  fingerprint.add(std::as_bytes(std::span(&status_, 1)));
  fingerprint.add(std::as_bytes(std::span(&outcome_.step, 1)));
  fingerprint.add(std::as_bytes(std::span(outcome_.reason)));
  return fingerprint.value();
}

std::uint64_t RunRecord::full_fingerprint() const {
  Fingerprint fingerprint;
  for (std::size_t c = layout_->usual_columns(); c < layout_->columns().size(); ++c) {
    fingerprint.add(bytes(c));
  }
  return fingerprint.value();
}

void RunRecord::expect_element(const Column& column, std::size_t size) {
  expect(size_of(column.element) == size, "a column was asked for as another element type");
}

void require_known(std::span<const RunStatus> statuses, const std::string& place) {
  if (std::ranges::all_of(statuses, [](RunStatus s) { return s <= RunStatus::not_needed; })) return;
  throw StudyError(place + ": a status is none of 0, 1, 2, 3 (the file is damaged): make it anew");
}

}  // namespace montecarta::engine
