// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/frame.hpp"

#include "analysis/study/prose.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/number_text.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace montecarta::analysis {

void Frame::add(const Row& row, const Row& more) {
  Row all = row;
  all.insert(all.end(), more.begin(), more.end());
  if (columns.empty()) {
    for (const Entry& entry : all) columns.push_back({entry.name, entry.units});
  }
  expect(all.size() == columns.size(), "all rows of a frame have the same columns");
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (all[c].is_text) {
      columns[c].texts.push_back(std::move(all[c].text));
    } else {
      columns[c].numbers.push_back(all[c].number);
    }
  }
}

void Frame::push(std::initializer_list<double> row) {
  expect(row.size() == columns.size(), "a row has a number for each column");
  auto column = columns.begin();
  for (const double number : row) (column++)->numbers.push_back(number);
}

std::size_t Frame::rows() const {
  return columns.empty() ? 0 : columns[0].numbers.size() + columns[0].texts.size();
}

std::string heading(const std::string& name, const std::string& units) {
  return units == "1" ? name : formatted("{} [{}]", name, units);
}

namespace {

std::string quoted(const std::string& field) {
  if (field.find_first_of(",\"\n\r") == std::string::npos) return field;
  return formatted("\"{}\"", replaced(field, "\"", "\"\""));
}

[[noreturn]] void cannot_write(const std::filesystem::path& path) {
  throw RunError("{}: cannot be written ({}): make room, or choose another place", path,
                 std::strerror(errno));
}

void write_in_place(const std::filesystem::path& path, const std::string& text) {
  errno = 0;
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) cannot_write(path);
}

/// Throws StudyError if `path` is a pipe, which would block, or a device.
const std::filesystem::path& not_special(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path) || std::filesystem::is_regular_file(path)) return path;
  throw StudyError(path.string() +
                   ": is no regular file (nothing else is ever replaced): choose another place");
}

}  // namespace

void write_csv(const Frame& frame, const std::filesystem::path& path) {
  errno = 0;
  std::ofstream out(not_special(path));
  std::string between;
  for (const Frame::Column& column : frame.columns) {
    out << std::exchange(between, ",") << quoted(heading(column.name, column.units));
  }
  if (!frame.columns.empty()) out << '\n';
  for (std::size_t r = 0; r < frame.rows(); ++r) {
    between.clear();
    for (const Frame::Column& column : frame.columns) {
      out << std::exchange(between, ",")
          << (column.texts.empty() ? exact_text(column.numbers[r]) : quoted(column.texts[r]));
    }
    out << '\n';
  }
  out.close();
  if (!out) cannot_write(path);
}

void make_directory(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error || !std::filesystem::is_directory(directory)) {
    throw RunError("{}: cannot be made ({}): choose another place", directory,
                   error ? error.message() : "something else has that name");
  }
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  const std::filesystem::path target = std::filesystem::weakly_canonical(path);
  const bool is_special =
      std::filesystem::exists(target) && !std::filesystem::is_regular_file(target);
  if (is_special) return write_in_place(target, text);
  std::filesystem::path draft = target;
  draft += formatted(".{}.new", ::getpid());
  try {
    write_in_place(draft, text);
    std::filesystem::rename(draft, target);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(draft, ignored);
    throw;
  }
}

}  // namespace montecarta::analysis
