// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/plan.hpp"
#include "engine/records/columns.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace montecarta::engine {

/// The columns a cell stores and where they lie in the memory of one run. Columns nobody asked for
/// are absent.
class RecordLayout {
 public:
  RecordLayout(const Cell& cell, const ColumnSelection& selection, const Itinerary& itinerary);

  /// In the order of the file.
  const std::vector<Column>& columns() const { return columns_; }
  /// Where column `c` begins [byte]; a multiple of 64.
  std::size_t offset(std::size_t c) const { return offsets_[c]; }
  /// Memory of one run [byte].
  std::size_t bytes() const { return bytes_; }
  /// Which column has this name; nullopt where it is not stored.
  std::optional<std::size_t> find(std::string_view name) const;
  /// Rows of `time` are scans, not steps (record.rate = scan).
  bool scans_only() const { return scans_only_; }
  std::size_t scans() const { return scans_; }
  std::size_t particles() const { return particles_; }
  std::size_t landmarks() const { return landmarks_; }
  /// Scans of the rows of the joint columns, in order; empty where there are none.
  const std::vector<std::uint32_t>& joint_scans() const { return joint_scans_; }

 private:
  std::vector<Column> columns_;
  std::vector<std::size_t> offsets_;
  std::size_t bytes_ = 0;
  bool scans_only_;
  std::size_t scans_;
  std::size_t particles_;
  std::size_t landmarks_;
  std::vector<std::uint32_t> joint_scans_;
};

}  // namespace montecarta::engine
