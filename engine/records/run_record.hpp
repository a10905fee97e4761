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

/// What is stored of a run: the columns of every run, or behind them also those that only the first
/// ColumnSelection::full_runs have.
enum class Detail : std::uint8_t { usual, full };

/// The columns a cell stores and where they lie in the memory of one run. Columns nobody asked for
/// are absent.
class RecordLayout {
 public:
  RecordLayout(const Cell& cell, const ColumnSelection& selection, const Itinerary& itinerary,
               Detail detail = Detail::usual);

  /// In the order of the file.
  const std::vector<Column>& columns() const { return columns_; }
  /// How many of them every run has; the others come behind.
  std::size_t usual_columns() const { return usual_columns_; }
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
  void add_columns(const Cell& cell, const ColumnSelection& selection, const AxisLengths& lengths);

  std::vector<Column> columns_;
  std::size_t usual_columns_ = 0;
  std::vector<std::size_t> offsets_;
  std::size_t bytes_ = 0;
  bool scans_only_;
  std::size_t scans_;
  std::size_t particles_;
  std::size_t landmarks_;
  std::vector<std::uint32_t> joint_scans_;
};

/// One for each cell of the plan.
std::vector<RecordLayout> layouts_of(const StudyPlan& plan, Detail detail);

/// State of one run of one cell; the numbers are those of the file's `status`. Spared: not made,
/// since the runs before it were enough.
enum class RunStatus : std::uint8_t { missing = 0, complete = 1, failed = 2, spared = 3 };

/// Whether a run of that state has left a record.
inline bool is_stored(RunStatus status) {
  return status == RunStatus::complete || status == RunStatus::failed;
}

/// Throws StudyError, beginning with `place`, where a number read from a file is none of these.
void expect_known(std::span<const RunStatus> statuses, const std::string& place);

/// Width of failure_reason in the file: fixed, so that a run's reason has its own place.
inline constexpr std::size_t kFailureReasonBytes = 128;

/// One run of one cell. Made once by each worker and cleared from run to run; allocates nothing
/// after construction. The layout must outlive it.
class RunRecord {
 public:
  /// In memory of its own.
  explicit RunRecord(const RecordLayout& layout);
  /// In memory that is lent, at least layout.bytes() aligned for doubles: a worker's records of all
  /// cells share one piece. Whoever lent it in between must clear() first.
  RunRecord(const RecordLayout& layout, std::span<std::byte> memory);
  RunRecord(RunRecord&&) = default;
  RunRecord& operator=(RunRecord&&) = default;

  /// Forgets the run: numbers become NaN, counts and flags 0, status missing.
  void clear();
  /// The run went through. `cpu_seconds`: processor time of the run's own thread over its steps
  /// (analysis/FORMAT.md, "/timing").
  void mark_complete(double cpu_seconds);
  /// The run ended at `step` (0-based) for `reason`; a longer reason than the file holds is cut at
  /// a character.
  void mark_failed(std::uint32_t step, std::string_view reason, double cpu_seconds);

  const RecordLayout& layout() const { return *layout_; }
  RunStatus status() const { return status_; }
  std::uint32_t failure_step() const { return outcome_.step; }
  std::string_view failure_reason() const;
  /// The reason as it goes to the file: zeros behind the text.
  std::span<const char> failure_text() const { return outcome_.reason; }
  double cpu_seconds() const { return cpu_seconds_; }

  /// Column `c` of the layout as it goes to the file, row by row in the machine's byte order.
  std::span<const std::byte> bytes(std::size_t c) const;
  /// The same as elements of `T`, whose size must be the column's.
  template <class T>
  std::span<T> column(std::size_t c) {
    const Column& described = layout_->columns()[c];
    expect_element(described, sizeof(T));
    return {reinterpret_cast<T*>(memory_.data() + layout_->offset(c)), described.elements()};
  }
  /// XXH3 of what every run has in /cells: columns, status, failure step and reason. Tells torn
  /// data from whole.
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
