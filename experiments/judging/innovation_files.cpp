// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/innovation_files.hpp"

#include "engine/formatted.hpp"
#include "experiments/files/files.hpp"
#include "experiments/judging/innovation_rows.hpp"
#include "experiments/judging/time_units.hpp"

#include <set>
#include <utility>

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

InnovationFiles::InnovationFiles(JudgedFiles files, std::optional<Gate> gate)
    : EstimateFiles(std::move(files), {}), gate_(std::move(gate)) {
  for (std::size_t c = 0; c < EstimateFiles::cells().size(); ++c) {
    const std::string& label = EstimateFiles::cells()[c];
    std::set<std::string> sensors;
    for (std::size_t run = 0; run < runs().size(); ++run) {
      for (std::string& sensor : sensors_in(EstimateFiles::place(c, run)))
        sensors.insert(std::move(sensor));
    }
    if (sensors.size() < 2) {
      labels_.push_back(label);
      parts_.push_back({c, ""});
      continue;
    }
    for (const std::string& sensor : sensors) {
      labels_.push_back(formatted("{}.{}", label, sensor));
      check_label(labels_.back());
      parts_.push_back({c, sensor});
    }
  }
}

std::vector<double> InnovationFiles::times(std::size_t cell, std::size_t run) const {
  return times_of(place(cell, run)).time;
}

StateRows InnovationFiles::estimates(std::size_t cell, std::size_t run) const {
  StateRows rows = times_of(place(cell, run));
  require_seconds(rows, place(cell, run));
  read_innovations(place(cell, run), place(cell, run), 0.0, rows,
                   {.sensor = parts_[cell].sensor, .gate = gate_, .with_components = true});
  return rows;
}

}  // namespace montecarta::experiments
