// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// Columns of numbers or texts over rows, with the names that they have in files: one CSV file, or
/// one HDF5 group.
struct Frame {
  struct Column {
    std::string name;         ///< e.g. "anees_pose_mixture"
    std::string units = "1";  ///< UDUNITS style, "1" where there is none
    std::vector<double> numbers = {};
    std::vector<std::string> texts = {};  ///< texts instead of numbers
  };
  /// A number of a row, or a text instead of it.
  struct Entry {
    Entry(std::string column, std::string words)
        : name(std::move(column)), text(std::move(words)), is_text(true) {}
    Entry(std::string column, std::string unit, double value)
        : name(std::move(column)), units(std::move(unit)), number(value) {}
    std::string name, units = "1", text = {};
    double number = 0.0;
    bool is_text = false;
  };
  using Row = std::vector<Entry>;

  /// Adds a row of `row` followed by `more`. The first row names the columns; all rows have the
  /// same.
  void add(const Row& row, const Row& more = {});

  /// Adds a row of numbers to existing columns.
  void push(std::initializer_list<double> row);

  std::size_t rows() const;

  std::vector<Column> columns = {};
};

/// The heading of a column: its name and, if it has one, the unit: position_rmse_mean [m].
std::string heading(const std::string& name, const std::string& units);

/// Writes columns below their names as comma-separated values (RFC 4180: fields with commas or
/// quotes are quoted). Throws RunError naming the file where it cannot be written.
void write_csv(const Frame& frame, const std::filesystem::path& path);

/// Makes a directory and its missing parents. Throws RunError if that fails.
void make_directory(const std::filesystem::path& directory);

/// Writes a whole file, binary or text. If that fails, the old file is unchanged, and RunError
/// names the file.
void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace montecarta::analysis
