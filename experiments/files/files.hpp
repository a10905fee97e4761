// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::experiments {

/// A file that comes with montecarta, e.g. ("worlds", "web_loop.csv"): beside the installed
/// executable (../share/montecarta), else in the source tree this was built from. nullopt where
/// there is none.
std::optional<std::filesystem::path> shipped_file(const std::string& folder,
                                                  const std::string& name);

/// Names without ending of the files of a shipped folder that end so, in alphabetical order.
std::vector<std::string> shipped_names(const std::string& folder, const std::string& ending);

/// A file of more bytes than this is no study, world or log, and would not fit into memory either.
inline constexpr std::uintmax_t kLargestFile = std::uintmax_t{512} << 20U;

/// All bytes of a file that the user named. Throws StudyError where there is none, where it is no
/// file (a folder, a device), cannot be read or is larger than kLargestFile.
std::string whole_file(const std::filesystem::path& path);
/// The text of a file in UTF-8, without a byte order mark. Throws StudyError as whole_file() does,
/// and if the file is in UTF-16 or holds NUL bytes.
std::string text_file(const std::filesystem::path& path);

/// The rows of a comma-separated text file: `#` begins a comment, empty lines do not count, the
/// first row names the columns. Errors (StudyError) name file and line.
class CsvRows {
 public:
  /// Reads the file and its header, which must be one of `headers`, e.g. "kind,x,y".
  CsvRows(const std::filesystem::path& path, std::span<const std::string> headers);
  /// Whatever its header is: see columns().
  explicit CsvRows(const std::filesystem::path& path);

  CsvRows(const CsvRows&) = delete;
  CsvRows& operator=(const CsvRows&) = delete;

  /// Which of the headers it has.
  std::size_t header() const { return header_; }
  /// Names of its columns, trimmed.
  std::vector<std::string> columns() const;
  /// Reads the next row; false after the last one. Throws unless it has as many fields as the
  /// header.
  bool next();
  /// Of the row that was read last, trimmed.
  std::string_view field(std::size_t i) const { return fields_[i]; }
  /// Field i as a finite number; `noun` says in the error what it should have been.
  double number(std::size_t i, const char* noun) const;
  /// "FILE:LINE" of the row that was read last.
  std::string place() const;

 private:
  /// Takes the next row that is not empty; nullopt at the end.
  std::optional<std::string_view> take_row();
  void refuse_open_end(std::string_view line) const;
  void read_header(std::span<const std::string> headers);

  std::string path_;
  std::string text_;
  std::string_view rest_;
  std::size_t line_ = 0;
  std::size_t header_ = 0;
  std::string header_text_;
  std::vector<std::string_view> fields_;
};

}  // namespace montecarta::experiments
