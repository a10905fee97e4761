// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/text/table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace montecarta::experiments {
namespace {

std::string printed(const char* format, double value) {
  std::array<char, 64> buffer;
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

std::string whole(double value) { return printed("%.0f", value); }

std::vector<std::size_t> widths_of(const std::vector<TableRow>& rows) {
  std::vector<std::size_t> widths;
  for (const TableRow& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  return widths;
}

}  // namespace

std::string aligned(const std::vector<TableRow>& rows, std::size_t indent) {
  const std::vector<std::size_t> widths = widths_of(rows);
  std::string text;
  for (const TableRow& row : rows) {
    std::string line(indent, ' ');
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i];
      if (i + 1 < row.size()) line += std::string(widths[i] - row[i].size() + 2, ' ');
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

std::string bytes_text(double bytes) {
  const std::array<const char*, 5> units = {" B", " kB", " MB", " GB", " TB"};
  std::size_t unit = 0;
  for (; bytes >= 999.5 && unit + 1 < units.size(); ++unit) bytes /= 1000.0;
  return printed(unit > 0 && bytes < 9.95 ? "%.1f" : "%.0f", bytes) + units[unit];
}

std::string duration_text(double seconds) {
  if (seconds < 59.95) return printed(seconds < 9.95 ? "%.1f s" : "%.0f s", seconds);
  const double minutes = std::floor((seconds + 0.5) / 60.0);
  if (minutes < 60.0)
    return whole(minutes) + " min " +
           printed("%02.0f s", std::max(0.0, std::floor(seconds + 0.5 - 60.0 * minutes)));
  return whole(std::floor(minutes / 60.0)) + " h " +
         printed("%02.0f min", std::fmod(minutes, 60.0));
}

}  // namespace montecarta::experiments
