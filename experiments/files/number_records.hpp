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

/// Where a record of numbers ends.
enum class RecordEnd {
  lines,  ///< with its line; empty lines do not count
  stream  ///< after its last number, wherever lines end
};

/// The records of a text file of numbers between white space, one after the other, each of the
/// same width. Strict: a word that is no finite number, a line with too few or too many and a last
/// record that is cut short are errors (StudyError) that name file and record.
class NumberRecords {
 public:
  NumberRecords(const std::filesystem::path& path, std::size_t width, RecordEnd end);
  NumberRecords(const NumberRecords&) = delete;
  NumberRecords& operator=(const NumberRecords&) = delete;

  /// The next record, valid until the next call; nullopt after the last one.
  std::optional<std::span<const double>> next();
  /// "FILE: record N", of the record that was read last (from 1).
  std::string place() const;

 private:
  void fill_from_stream();
  void fill_from_line();
  double number(std::string_view word) const;
  [[noreturn]] void refuse_count(std::size_t found, const char* why) const;

  std::string path_;
  std::string text_;
  std::string_view rest_;
  std::vector<double> record_;
  RecordEnd end_;
  std::size_t read_ = 0;
};

}  // namespace montecarta::experiments
