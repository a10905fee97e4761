// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// Columns of numbers or texts over rows, under the names that they have in files: one CSV file, or
/// a group of HDF5.
struct Frame {
  struct Column {
    std::string name;         ///< e.g. "anees_pose_mixture"
    std::string units = "1";  ///< UDUNITS style, "1" where there is none
    std::vector<double> numbers = {};
    std::vector<std::string> texts = {};  ///< in place of numbers
  };
  /// A number of a row, or a text in its place.
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

  /// Adds a row, `more` behind `row`. The first row names the columns, and all have the same.
  void add(const Row& row, const Row& more = {});

  /// Adds a row of numbers to columns that are there.
  void push(std::initializer_list<double> row);

  std::size_t rows() const;

  std::vector<Column> columns = {};
};

/// The unit belongs to the name where there is one: position_rmse_mean [m].
std::string heading(const std::string& name, const std::string& units);

/// Writes columns below their names as comma-separated values (RFC 4180: fields with commas or
/// quotes are quoted). Throws RunError naming the file where it cannot be written.
void write_csv(const Frame& frame, const std::filesystem::path& path);

/// Makes a directory and those above it. Throws RunError if that fails.
void make_directory(const std::filesystem::path& directory);

/// Writes a whole file, binary or text. If it fails, the old file is unchanged, and it throws
/// RunError with the name of the file.
void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace montecarta::analysis
