// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/plan.hpp"
#include "engine/namespaces.hpp"
#include "engine/records/columns.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::engine {

/// The stored columns of a run: those of every run, or also those that only the first
/// ColumnSelection::full_runs have.
enum class Detail : std::uint8_t { usual, full };

/// The columns that a cell stores, and their places in the memory of one run. Other columns are
/// absent.
class RecordLayout {
 public:
  RecordLayout(const Cell& cell, const ColumnSelection& selection, const Itinerary& itinerary,
               Detail detail = Detail::usual);

  /// All columns, in the order of the file.
  const std::vector<Column>& columns() const { return columns_; }
  /// Number of columns that every run has. The others follow them.
  std::size_t usual_columns() const { return usual_columns_; }
  /// Offset of column `c` [byte], a multiple of 64.
  std::size_t offset(std::size_t c) const { return offsets_[c]; }
  /// Memory of one run [byte].
  std::size_t bytes() const { return bytes_; }
  /// Index of the column of that name; nullopt if it is not stored.
  std::optional<std::size_t> find(std::string_view name) const;
  /// Returns whether the rows of `time` are scans instead of steps (record.rate = scan).
  bool scans_only() const { return scans_only_; }
  std::size_t scans() const { return scans_; }
  std::size_t particles() const { return particles_; }
  std::size_t landmarks() const { return landmarks_; }
  /// The scans of the rows of the joint columns, in order; empty if there are none.
  const std::vector<std::uint32_t>& joint_scans() const { return joint_scans_; }
  /// Names of the columns that the filter declares itself, stored or not, in the order of
  /// ScanReport::own.
  const std::vector<std::string>& own_columns() const { return own_columns_; }

 private:
  void add_columns(const Cell& cell, const ColumnSelection& selection, const AxisLengths& lengths);
  void add_column(Column column, const AxisLengths& lengths);

  std::vector<Column> columns_;
  std::size_t usual_columns_ = 0;
  std::vector<std::size_t> offsets_;
  std::size_t bytes_ = 0;
  bool scans_only_;
  std::size_t scans_;
  std::size_t particles_;
  std::size_t landmarks_;
  std::vector<std::uint32_t> joint_scans_;
  std::vector<std::string> own_columns_;
};

/// One layout for each cell of the plan.
std::vector<RecordLayout> layouts_of(const StudyPlan& plan, Detail detail);

/// State of one run of one cell, with the numbers of the file's `status`. A run that is not needed
/// was not made, because the runs before it were enough.
enum class RunStatus : std::uint8_t { missing = 0, complete = 1, failed = 2, not_needed = 3 };

/// Returns whether a run with that status has a stored record.
inline bool is_stored(RunStatus status) {
  return status == RunStatus::complete || status == RunStatus::failed;
}

/// Throws StudyError that begins with `place` if a number from a file is no status.
void require_known(std::span<const RunStatus> statuses, const std::string& place);

/// Width of failure_reason in the file. It is fixed, so that each run has its place.
inline constexpr std::size_t kFailureReasonBytes = 128;

/// One run of one cell. Each worker makes it once and clears it for every run; it allocates nothing
/// after construction. The layout must outlive it.
class RunRecord {
 public:
  /// Allocates its own memory.
  explicit RunRecord(const RecordLayout& layout);
  /// Uses given memory of at least layout.bytes() bytes that is aligned for doubles: the records of
  /// all cells of a worker share one buffer. After another record has used it, clear() must be
  /// called.
  RunRecord(const RecordLayout& layout, std::span<std::byte> memory);
  RunRecord(RunRecord&&) = default;
  RunRecord& operator=(RunRecord&&) = default;

  /// Resets the record: numbers become NaN, counts and flags 0, the status missing.
  void clear();
  /// Marks the run as complete. `cpu_seconds` is the processor time of the run's own thread over
  /// its steps (analysis/FORMAT.md, "/timing").
  void mark_complete(double cpu_seconds);
  /// Marks the run as failed at `step` (from 0) for `reason`, which is cut between two characters
  /// if it is longer than its place in the file.
  void mark_failed(std::uint32_t step, std::string_view reason, double cpu_seconds);

  const RecordLayout& layout() const { return *layout_; }
  RunStatus status() const { return status_; }
  std::uint32_t failure_step() const { return outcome_.step; }
  /// The reason as stored in the file, padded with zeros.
  std::span<const char> failure_text() const { return outcome_.reason; }
  double cpu_seconds() const { return cpu_seconds_; }

  /// Column `c` of the layout as stored in the file, row by row in the byte order of the machine.
  std::span<const std::byte> bytes(std::size_t c) const;
  /// Column `c` as elements of type T, which must have the element size of the column.
  template <class T>
  std::span<T> column(std::size_t c) {
    const Column& described = layout_->columns()[c];
    expect_element(described, sizeof(T));
    return {reinterpret_cast<T*>(memory_.data() + layout_->offset(c)), described.elements()};
  }
  /// XXH3 of the data of every run in /cells: columns, status, failure step and reason. Detects
  /// damaged data.
  std::uint64_t fingerprint() const;
  /// XXH3 of the columns that only the first runs have.
  std::uint64_t full_fingerprint() const;

 private:
  static void expect_element(const Column& column, std::size_t size);

  const RecordLayout* layout_;
  std::vector<std::byte> own_memory_;
  std::span<std::byte> memory_;
  RunStatus status_ = RunStatus::missing;
  struct Outcome {
    std::uint32_t step = 0;
    std::array<char, kFailureReasonBytes> reason{};
  } outcome_;
  double cpu_seconds_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace montecarta::engine
