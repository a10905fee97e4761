// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Writes a file of comma-separated values (RFC 4180: fields with commas or quotes are quoted), row
/// by row. Every member throws RunError naming the file where it cannot be written.
class CsvFile {
 public:
  explicit CsvFile(const std::filesystem::path& path);

  void row(const std::vector<std::string>& fields);
  void row(const std::vector<double>& numbers);
  /// Call last: tells when the disk was full.
  void close();

 private:
  void check();

  std::filesystem::path path_;
  std::ofstream out_;
};

/// Makes a directory and those above it. Throws RunError where it cannot.
void make_directory(const std::filesystem::path& directory);

/// Writes a whole file, binary or text: under its name there is all of it or what was there before.
/// Throws RunError naming it.
void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace montecarta::analysis
