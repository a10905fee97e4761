// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// Writes a file of comma-separated values (RFC 4180: fields with commas or quotes are quoted), row
/// by row. Every member throws RunError naming the file where it cannot be written.
class CsvFile {
 public:
  explicit CsvFile(const std::filesystem::path& path);

  void row(const std::vector<std::string>& fields);
  void row(const std::vector<double>& numbers);
  /// Must be called last: throws if the disk was full.
  void close();

 private:
  void check();

  std::filesystem::path path_;
  std::ofstream out_;
};

/// Makes a directory and those above it. Throws RunError if that fails.
void make_directory(const std::filesystem::path& directory);

/// Writes a whole file, binary or text. If it fails, the old file is unchanged, and it throws
/// RunError with the name of the file.
void write_text(const std::filesystem::path& path, const std::string& text);

/// One number under the name it has in files.
struct NamedNumber {
  std::string name;
  std::string units;  ///< UDUNITS style, "1" where there is none
  double value = 0.0;
};

/// A number of every scan, under the name it has in files.
struct NamedSeries {
  std::string name;   ///< e.g. "anees_pose_mixture"
  std::string units;  ///< UDUNITS style, "1" where there is none
  std::vector<double> values;
};

/// The unit belongs to the name where there is one: position_rmse_mean [m].
std::string heading(const std::string& name, const std::string& units);

/// A CSV file of rows that begin with texts and go on with numbers, all under names: the first row
/// gives the headings, and every row has the same ones.
class NamedRows {
 public:
  explicit NamedRows(const std::filesystem::path& path) : file_(path) {}
  /// `texts` are (name, text).
  void row(const std::vector<std::pair<std::string, std::string>>& texts,
           const std::vector<NamedNumber>& numbers);
  /// Throws RunError where the disk did not take it all.
  void close() { file_.close(); }

 private:
  CsvFile file_;
  bool is_headed_ = false;
};

}  // namespace montecarta::analysis
