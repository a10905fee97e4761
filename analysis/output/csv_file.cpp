// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/csv_file.hpp"

#include "analysis/output/number_text.hpp"
#include "analysis/output/prose.hpp"
#include "engine/errors.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace montecarta::analysis {
namespace {

std::string quoted(const std::string& field) {
  if (field.find_first_of(",\"\n\r") == std::string::npos) return field;
  return "\"" + replaced(field, "\"", "\"\"") + "\"";
}

[[noreturn]] void cannot_write(const std::filesystem::path& path) {
  throw RunError(path.string() + ": cannot be written (" + std::strerror(errno) +
                 "): make room, or choose another place");
}

void write_in_place(const std::filesystem::path& path, const std::string& text) {
  errno = 0;
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) cannot_write(path);
}

/// A pipe would be waited for, a device written to.
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
    throw RunError(directory.string() + ": cannot be made (" +
                   (error ? error.message() : "something else has that name") +
                   "): choose another place");
  }
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  const std::filesystem::path target = std::filesystem::weakly_canonical(path);
  const bool is_special =
      std::filesystem::exists(target) && !std::filesystem::is_regular_file(target);
  if (is_special) return write_in_place(target, text);
  std::filesystem::path draft = target;
  draft += "." + std::to_string(::getpid()) + ".new";
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
