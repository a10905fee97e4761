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

}  // namespace montecarta::analysis
