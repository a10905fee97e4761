// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/innovation_files.hpp"

#include "experiments/files/files.hpp"
#include "experiments/judging/innovation_rows.hpp"

namespace montecarta::experiments {

std::vector<double> InnovationFiles::times(std::size_t cell, std::size_t run) const {
  CsvRows file(place(cell, run));
  std::vector<double> times;
  while (file.next()) {
    const double time = file.time(CsvRows::Order::not_earlier);
    if (times.empty() || time > times.back()) times.push_back(time);
  }
  return times;
}

StateRows InnovationFiles::estimates(std::size_t cell, std::size_t run) const {
  StateRows rows{.time = times(cell, run)};
  read_innovations(place(cell, run), place(cell, run), 0.0, rows);
  return rows;
}

}  // namespace montecarta::experiments
