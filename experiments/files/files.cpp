// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/files.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <fstream>
#include <set>
#include <system_error>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

std::array<fs::path, 3> shipped_roots() {
  return {program_path().parent_path().parent_path() / "share" / "montecarta",
          MONTECARTA_INSTALLED_DIR, MONTECARTA_SHIPPED_DIR};
}

bool has_letter(std::string_view text) {
  return std::ranges::any_of(text, [](unsigned char c) { return std::isalpha(c) != 0; });
}

/// Remedy of numbers with a decimal comma.
constexpr const char* kDecimalPoints = "write decimal points, and commas between the columns";

}  // namespace

fs::path program_path() {
  std::error_code none;
  fs::path program = fs::read_symlink("/proc/self/exe", none);
  const std::string folder = program.parent_path().string();
  if (!folder.ends_with(formatted("/{}", kWiderFolder))) return program;
  const std::string prefix = folder.substr(0, folder.size() - std::strlen(kWiderFolder));
  return fs::path(prefix) / "bin" / program.filename();
}

std::optional<fs::path> shipped_file(const std::string& folder, const std::string& name) {
  for (const fs::path& root : shipped_roots()) {
    std::error_code none;
    if (fs::is_regular_file(root / folder / name, none)) return root / folder / name;
  }
  return std::nullopt;
}

fs::path shipped_folder(const std::string& folder) {
  for (const fs::path& root : shipped_roots()) {
    std::error_code none;
    if (fs::is_directory(root / folder, none)) return root / folder;
  }
  throw StudyError(
      "{}: not part of this installation: take the folder experiments/{} of the sources", folder,
      folder);
}

std::vector<std::string> shipped_names(const std::string& folder, const std::string& ending) {
  std::set<std::string> names;
  for (const fs::path& root : shipped_roots()) {
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(root / folder, none)) {
      if (entry.path().extension() == ending) names.insert(entry.path().stem().string());
    }
  }
  return {names.begin(), names.end()};
}

std::string whole_file(const std::filesystem::path& path) {
  std::error_code failure;
  const bool is_file = std::filesystem::is_regular_file(path, failure);
  const std::uintmax_t size = is_file ? std::filesystem::file_size(path, failure) : 0;
  std::ifstream file(path, std::ios::binary);
  if (!is_file || failure || !file) {
    throw StudyError(path.string() +
                     ": cannot be opened (is it there, a file, and readable?): check the path");
  }
  if (size > kLargestFile) {
    throw StudyError("{}: {} bytes (at most 512 MiB are read): split it or thin it out", path,
                     size);
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (file.gcount() != static_cast<std::streamsize>(bytes.size())) {
    throw StudyError(
        "{}: ends before its last byte (did it change while it was read?): read it again", path);
  }
  return bytes;
}

std::string text_file(const std::filesystem::path& path) {
  constexpr std::string_view kUtf8 = "\xEF\xBB\xBF", kUtf16[] = {"\xFF\xFE", "\xFE\xFF"};
  std::string text = whole_file(path);
  if (text.starts_with(kUtf16[0]) || text.starts_with(kUtf16[1])) {
    throw StudyError(path.string() +
                     ": is in UTF-16 (two bytes a character; UTF-8 is read): save it as UTF-8");
  }
  if (text.starts_with(kUtf8)) text.erase(0, kUtf8.size());
  const std::size_t nul = text.find('\0');
  if (nul == text.npos) return text;
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(nul), '\n');
  throw StudyError("{}:{}: a NUL byte (this is no text, or it is damaged): save it as UTF-8", path,
                   line);
}

CsvRows::CsvRows(const std::filesystem::path& path, std::span<const std::string> headers)
    : path_(path.string()), text_(text_file(path)), rest_(text_) {
  read_header(headers);
}

std::string CsvRows::place() const { return formatted("{}:{}", path_, line_); }

void CsvRows::refuse(const std::string& fault) const { throw StudyError("{}: {}", place(), fault); }

void CsvRows::require_some() const {
  if (has_rows_) return;
  throw StudyError(path_ + ": no rows behind the header (a file has at least one): write the rows");
}

/// A number at the end of a truncated file may be incomplete and still be valid, so a last line
/// without line break is refused.
void CsvRows::refuse_open_end(std::string_view line) const {
  if (trimmed(line.substr(0, line.find('#'))).empty()) return;
  refuse(
      "the last row has no end (the file may have been cut short): end it with a line break if it "
      "is whole");
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

void CsvRows::refuse_other_separators(std::string_view row) const {
  if (row.find(';') != row.npos) {
    refuse(formatted("semicolons separate the columns (commas are read): {}, e.g. 0.5,2.25",
                     kDecimalPoints));
  }
  if (row.find(',') != row.npos || !has_letter(row)) return;
  if (row.find_first_of("\t |") == row.npos) return;
  refuse(std::string(row.find('\t') != row.npos  ? "tabs"
                     : row.find('|') != row.npos ? "vertical bars"
                                                 : "blanks") +
         " separate the columns (commas are read): write commas");
}

void CsvRows::refuse_number_of_fields(std::string_view row, std::size_t fields) const {
  refuse_other_separators(row);
  const std::string remedy = "write one field for each column";
  const std::string fault = formatted("{} fields (a row is {}): ", fields, joined(columns_, ","));
  if (fields < columns_.size()) refuse(fault + remedy);
  if (row.find('"') != row.npos) {
    refuse(
        formatted("numbers in quotes with decimal commas ({} fields for {} columns): remove the "
                  "quotes, and {}",
                  fields, columns_.size(), kDecimalPoints));
  }
  if (row.find('.') == row.npos) {
    refuse(formatted("decimal commas ({} fields for {} columns, and no decimal point): {}", fields,
                     columns_.size(), kDecimalPoints));
  }
  refuse(fault + remedy);
}

void CsvRows::read_header(std::span<const std::string> headers) {
  const std::string remedy = headers.empty() ? "their names" : joined(headers, " or ");
  const std::optional<std::string_view> row = take_row();
  if (!row) {
    throw StudyError("{}: empty (the first row names the columns): begin with {}", path_, remedy);
  }
  refuse_other_separators(*row);
  if (row->find('"') != row->npos) {
    refuse("names in quotes (they are read as part of the names): remove the quotes");
  }
  constexpr std::size_t kLongestHeader = 200;  // no known header is longer
  const std::size_t length = headers.empty() ? row->size() : kLongestHeader;
  columns_ = split(row->substr(0, length), ',');
  if (headers.empty()) return;
  const auto known = std::ranges::find(headers, joined(columns_, ","));
  if (known == headers.end()) {
    refuse(formatted("'{}' is not the header (the first row names the columns): begin with {}",
                     excerpt(*row), remedy));
  }
  header_ = static_cast<std::size_t>(known - headers.begin());
}

bool CsvRows::next() {
  const std::optional<std::string_view> row = take_row();
  if (!row) return false;
  const auto fields = static_cast<std::size_t>(std::ranges::count(*row, ',')) + 1;
  if (fields != columns_.size()) refuse_number_of_fields(*row, fields);
  split_into(*row, ',', fields_);
  return has_rows_ = true;
}

namespace {

/// Whether a text stands for a number that is missing.
bool is_name_of_nothing(std::string_view text) {
  constexpr std::array kNames = {"", "nan", "na", "n/a", "null", "none", "-", "--"};
  std::string small(text.substr(0, text.find('(')));
  std::ranges::transform(small, small.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::count(kNames, small) > 0;
}

}  // namespace

double CsvRows::number(std::size_t i, const char* noun) const {
  if (const std::optional<double> value = to_number(field(i))) return *value;
  const bool is_quoted = field(i).starts_with('"') || field(i).starts_with('\'');
  refuse(formatted("'{}' is no {} (a finite number is needed): {}", excerpt(field(i)), noun,
                   is_quoted                      ? "remove the quotes"
                   : is_name_of_nothing(field(i)) ? "leave out rows in which something is missing"
                                                  : "write e.g. 12.5"));
}

void CsvRows::refuse_equal_times(const std::string& other_remedy) const {
  constexpr std::size_t kFewDigits = 10;   // of the time in s since 1970, these are whole seconds
  constexpr std::size_t kLeastDigits = 5;  // fewer are no loss, but a round number
  const std::string_view text = field(0);
  const std::string_view mantissa = text.substr(0, text.find_first_of("eE"));
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t first = std::min(mantissa.find_first_of("123456789"), mantissa.size());
  const auto digits = static_cast<std::size_t>(std::ranges::count_if(
      mantissa.substr(first), [](unsigned char c) { return std::isdigit(c) != 0; }));
  const bool is_whole =
      mantissa.size() == text.size() && mantissa.find_first_not_of("0.", point) == mantissa.npos;
  std::string why = "the row before has the same time";
  if (is_whole) {
    why += ", and it is printed in whole seconds";
  } else if (digits >= kLeastDigits && digits <= kFewDigits) {
    why += formatted(", and {} digits are printed", digits);
  }
  refuse(formatted("equal times {} s ({}): print times with 15 digits, or {}", excerpt(text), why,
                   other_remedy));
}

double CsvRows::time(Order order, const std::string& other_remedy) {
  const double before = last_time_;
  last_time_ = number(0, "time");
  if (last_time_ > before || (last_time_ == before && order == Order::not_earlier))
    return last_time_;
  if (last_time_ == before) refuse_equal_times("leave one of the rows out" + other_remedy);
  refuse(formatted("time {} s comes after {} s (rows go forward in time): sort them{}",
                   to_text(last_time_), to_text(before), other_remedy));
}

}  // namespace montecarta::experiments
