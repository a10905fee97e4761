// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/innovation_files.hpp"

#include "experiments/files/files.hpp"
#include "experiments/judging/innovation_rows.hpp"
#include "experiments/judging/time_units.hpp"

namespace montecarta::experiments {

namespace {

/// The times of a file, with the first line of each.
StateRows times_of(const std::filesystem::path& path) {
  CsvRows file(path);
  StateRows rows;
  while (file.next()) {
    const double time = file.time(CsvRows::Order::not_earlier);
    if (!rows.time.empty() && time == rows.time.back()) continue;
    rows.time.push_back(time);
    rows.line.push_back(file.line());
  }
  return rows;
}

}  // namespace

std::vector<double> InnovationFiles::times(std::size_t cell, std::size_t run) const {
  return times_of(place(cell, run)).time;
}

StateRows InnovationFiles::estimates(std::size_t cell, std::size_t run) const {
  StateRows rows = times_of(place(cell, run));
  require_seconds(rows, place(cell, run));
  read_innovations(place(cell, run), place(cell, run), 0.0, rows);
  return rows;
}

}  // namespace montecarta::experiments
