// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/number_records.hpp"

#include "engine/errors.hpp"
#include "experiments/files/files.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>

namespace montecarta::experiments {
namespace {

bool is_white(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

void skip_white(std::string_view& text) {
  const auto word = std::find_if_not(text.begin(), text.end(), is_white);
  text.remove_prefix(static_cast<std::size_t>(word - text.begin()));
}

/// Takes the next word off `text`; empty where there is none.
std::string_view take_word(std::string_view& text) {
  skip_white(text);
  const auto end = std::find_if(text.begin(), text.end(), is_white);
  const std::string_view word = text.substr(0, static_cast<std::size_t>(end - text.begin()));
  text.remove_prefix(word.size());
  return word;
}

}  // namespace

NumberRecords::NumberRecords(const std::filesystem::path& path, std::size_t width, RecordEnd end)
    : path_(path.string()), text_(text_file(path)), rest_(text_), record_(width), end_(end) {}

std::optional<std::span<const double>> NumberRecords::next() {
  skip_white(rest_);
  if (rest_.empty()) return std::nullopt;
  ++read_;
  if (end_ == RecordEnd::lines) {
    fill_from_line();
  } else {
    fill_from_stream();
  }
  return record_;
}

std::string NumberRecords::place() const { return path_ + ": record " + std::to_string(read_); }

void NumberRecords::fill_from_stream() {
  for (std::size_t i = 0; i < record_.size(); ++i) {
    const std::string_view word = take_word(rest_);
    if (word.empty()) refuse_count(i, "the file ends, or numbers are missing before");
    record_[i] = number(word);
  }
}

void NumberRecords::fill_from_line() {
  const std::size_t length = std::min(rest_.find('\n'), rest_.size());
  std::string_view line = rest_.substr(0, length);
  rest_.remove_prefix(length);
  std::size_t found = 0;
  for (auto word = take_word(line); !word.empty(); word = take_word(line), ++found) {
    if (found < record_.size()) record_[found] = number(word);
  }
  if (found != record_.size()) refuse_count(found, "a record is a line");
}

double NumberRecords::number(std::string_view word) const {
  if (word.end() == text_.data() + text_.size()) {
    throw StudyError(place() + ": '" + excerpt(word) +
                     "' ends with the file (it may have been cut short within the number): take "
                     "the whole file as published");
  }
  if (const std::optional<double> value = to_number(word)) return *value;
  throw StudyError(place() + ": '" + excerpt(word) +
                   "' is no finite number (only numbers stand here): correct it or take the " +
                   "file as published");
}

void NumberRecords::refuse_count(std::size_t found, const char* why) const {
  throw StudyError(place() + ": " + std::to_string(found) + " of " +
                   std::to_string(record_.size()) + " numbers (" + why +
                   "): take the whole file as published");
}

}  // namespace montecarta::experiments
