// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::experiments {

/// Folder of an installation, beside `bin`, that has a second program for wider registers
/// (package/wider_program).
inline constexpr const char* kWiderFolder = "lib/montecarta/x86-64-v4";

/// The program that is running, as a user starts it: the one in `bin` also if that one has started
/// the program of kWiderFolder.
std::filesystem::path program_path();

/// A file that is shipped with montecarta, e.g. ("worlds", "web_loop.csv"): beside the installed
/// executable (../share/montecarta), otherwise in the source tree of this build. nullopt if there
/// is none.
std::optional<std::filesystem::path> shipped_file(const std::string& folder,
                                                  const std::string& name);

/// A folder that is shipped with montecarta, found as shipped_file() finds files. Throws StudyError
/// if this installation has none.
std::filesystem::path shipped_folder(const std::string& folder);

/// Names, without `ending`, of the files with this ending in a shipped folder, in alphabetical
/// order.
std::vector<std::string> shipped_names(const std::string& folder, const std::string& ending);

/// Largest size of an input file [byte]. No study, world or log is larger, and larger files may not
/// fit into memory.
inline constexpr std::uintmax_t kLargestFile = std::uintmax_t{512} << 20U;

/// All bytes of a file that the user named. Throws StudyError if the file does not exist, is not a
/// regular file (but a folder or a device), cannot be read or is larger than kLargestFile.
std::string whole_file(const std::filesystem::path& path);
/// The text of a file in UTF-8, without a byte order mark. Throws StudyError in the same cases as
/// whole_file(), and if the file is in UTF-16 or contains NUL bytes.
std::string text_file(const std::filesystem::path& path);

/// The rows of a comma-separated text file: `#` begins a comment, empty lines are ignored, and the
/// first row names the columns. Errors (StudyError) name file and line.
class CsvRows {
 public:
  /// Reads the file and its header, which must be one of `headers`, e.g. "kind,x,y". Without
  /// `headers` it may be any, which columns() returns.
  explicit CsvRows(const std::filesystem::path& path, std::span<const std::string> headers = {});

  CsvRows(const CsvRows&) = delete;
  CsvRows& operator=(const CsvRows&) = delete;

  /// Index of the file's header in `headers`.
  std::size_t header() const { return header_; }
  /// Names of the columns, trimmed.
  const std::vector<std::string>& columns() const { return columns_; }
  /// Reads the next row; false after the last one. Throws StudyError if the number of fields
  /// differs from that of the header.
  bool next();
  /// Field i of the current row, trimmed.
  std::string_view field(std::size_t i) const { return fields_[i]; }
  /// Field i as a finite number; `noun` names the quantity in errors.
  double number(std::size_t i, const char* noun) const;
  /// The required order of a row's time and that of the row before.
  enum class Order { later, not_earlier };
  /// Field 0 as a time [s]. Throws StudyError if it is not in order; `other_remedy` is the end of
  /// the error, for instance a script that repairs the file.
  double time(Order order = Order::later, const std::string& other_remedy = {});
  /// Refuses a row whose time equals that of the row before. The error counts the digits of the
  /// time if they are few, and ends with `other_remedy`.
  [[noreturn]] void refuse_equal_times(const std::string& other_remedy) const;
  /// "FILE:LINE" of the current row.
  std::string place() const;
  /// Line of the current row, from 1.
  std::size_t line() const { return line_; }
  /// Throws StudyError with the place of the current row and `fault`, worded "problem (why):
  /// remedy".
  [[noreturn]] void refuse(const std::string& fault) const;
  /// Checks the file at its end: throws StudyError if it has no rows after the header.
  void require_some() const;

 private:
  /// Takes the next row that is not empty; nullopt at the end.
  std::optional<std::string_view> take_row();
  void refuse_open_end(std::string_view line) const;
  /// Refuses a row or header whose fields are not separated by commas.
  void refuse_other_separators(std::string_view row) const;
  [[noreturn]] void refuse_number_of_fields(std::string_view row, std::size_t fields) const;
  void read_header(std::span<const std::string> headers);

  std::string path_;
  std::string text_;
  std::string_view rest_;
  std::size_t line_ = 0;
  bool has_rows_ = false;
  double last_time_ = -std::numeric_limits<double>::infinity();
  std::size_t header_ = 0;
  std::vector<std::string> columns_;
  std::vector<std::string_view> fields_;
};

}  // namespace montecarta::experiments
