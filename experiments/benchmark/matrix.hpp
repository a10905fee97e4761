// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/frame.hpp"
#include "analysis/study/text_table.hpp"
#include "experiments/benchmark/archive_entry.hpp"

#include <string>
#include <vector>

namespace montecarta::experiments {

/// The filters of a benchmark in its worlds.
struct Matrix {
  /// One filter in one world.
  struct Place {
    const ArchiveEntry* entry = nullptr;  ///< nullptr if there is no result
    bool suits = true;                    ///< whether the world suits the filter
    /// RMSE of the position divided by that of full smoothing, over the runs that both completed;
    /// NaN without one of them.
    double relative_error = kNaN;
  };
  struct Row {
    std::string label;
    std::vector<Place> places;  ///< {world}
  };
  std::vector<std::string> worlds;
  std::vector<Row> rows;
};

/// Label of the filter that errors are relative to.
inline constexpr const char* kSmootherLabel = "smoother";

/// Root of the mean of the squared position errors of an entry divided by that of another one, over
/// the runs that both completed.
double relative_error(const ArchiveEntry& entry, const ArchiveEntry& reference);

/// The matrix of entries, which must outlive it. Rows are the shipped filters in their order, then
/// others; rows and worlds without any entry are left out.
Matrix matrix_of(const std::vector<ArchiveEntry>& entries);

/// The class of a verdict as the matrix shows it.
struct VerdictClass {
  const char* name;    ///< name for readers
  const char* mark;    ///< one character, behind a ratio
  const char* colour;  ///< of a cell, under black text
};
const VerdictClass& class_of(const ArchivedVerdict& verdict);
/// All classes, in the order of the legend.
std::vector<VerdictClass> verdict_classes();

/// A NEES ratio in few characters: "1.02", "73", "> 1e4", and "?" if it is not tested.
std::string ratio_text(double ratio);

/// A table of NEES ratios with the marks of their verdicts, for a terminal, and its legend.
TextTable ratio_table(const Matrix& matrix);
std::string legend_text(const Matrix& matrix);

/// A table of the filters in one world: verdict, NEES ratio with its interval, errors and cost.
TextTable world_table(const Matrix& matrix, std::size_t world);

/// One row for each entry, with all numbers.
Frame matrix_frame(const Matrix& matrix);

}  // namespace montecarta::experiments
