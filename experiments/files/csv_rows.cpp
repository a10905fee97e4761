// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/csv_rows.hpp"

#include "engine/errors.hpp"
#include "experiments/files/files.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>

namespace montecarta::experiments {
namespace {

std::size_t columns_of(std::string_view row) {
  return 1 + static_cast<std::size_t>(std::ranges::count(row, ','));
}

/// `row` without white space around its fields.
std::string tight(std::string_view row) {
  constexpr std::size_t kLongestHeader = 200;
  return joined(split(row.substr(0, kLongestHeader), ','), ",");
}

}  // namespace

CsvRows::CsvRows(const std::filesystem::path& path, std::span<const std::string> headers)
    : path_(path.string()), text_(text_file(path)), rest_(text_) {
  read_header(headers);
}

CsvRows::CsvRows(const std::filesystem::path& path)
    : path_(path.string()), text_(text_file(path)), rest_(text_) {
  const std::optional<std::string_view> row = take_row();
  if (!row) {
    throw StudyError(path_ + ": empty (the first row names the columns): begin with their names");
  }
  header_text_ = joined(split(*row, ','), ",");
}

std::vector<std::string> CsvRows::columns() const { return split(header_text_, ','); }

std::string CsvRows::place() const { return path_ + ":" + std::to_string(line_); }

/// A file that was cut short may end in a number that reads as another one.
void CsvRows::refuse_open_end(std::string_view line) const {
  if (trimmed(line.substr(0, line.find('#'))).empty()) return;
  throw StudyError(place() +
                   ": the last row has no end (the file may have been cut short): end it "
                   "with a line break if it is whole");
}

std::optional<std::string_view> CsvRows::take_row() {
  while (!rest_.empty()) {
    const std::size_t length = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = rest_.substr(0, length);
    const bool ended = length < rest_.size();
    rest_.remove_prefix(std::min(length + 1, rest_.size()));
    ++line_;
    if (!ended) refuse_open_end(line);
    const std::string_view row = trimmed(line.substr(0, line.find('#')));
    if (!row.empty()) return row;
  }
  return std::nullopt;
}

void CsvRows::read_header(std::span<const std::string> headers) {
  const std::optional<std::string_view> row = take_row();
  if (!row) {
    throw StudyError(path_ + ": empty (the first row names the columns): begin with " +
                     joined(headers, " or "));
  }
  header_text_ = tight(*row);
  const auto known = std::ranges::find(headers, header_text_);
  if (known == headers.end()) {
    throw StudyError(place() + ": '" + excerpt(*row) +
                     "' is not the header (the first row names the columns): begin with " +
                     joined(headers, " or "));
  }
  header_ = static_cast<std::size_t>(known - headers.begin());
}

bool CsvRows::next() {
  const std::optional<std::string_view> row = take_row();
  if (!row) return false;
  if (columns_of(*row) != columns_of(header_text_)) {
    throw StudyError(place() + ": " + std::to_string(columns_of(*row)) + " fields (a row is " +
                     header_text_ + "): write one field for each column");
  }
  split_into(*row, ',', fields_);
  return true;
}

double CsvRows::number(std::size_t i, const char* noun) const {
  if (const std::optional<double> value = to_number(field(i))) return *value;
  throw StudyError(place() + ": '" + excerpt(field(i)) + "' is no " + noun +
                   " (a finite number is needed): write e.g. 12.5");
}

}  // namespace montecarta::experiments
