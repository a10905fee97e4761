// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/innovation_files.hpp"

#include "engine/errors.hpp"
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

InnovationFiles::InnovationFiles(JudgedFiles files, const std::optional<Gates>& gates)
    : EstimateFiles(std::move(files), {}) {
  std::vector<Sensors> all;
  std::set<std::string> names;
  for (std::size_t c = 0; c < EstimateFiles::cells().size(); ++c) {
    all.push_back(innovations_of(c));
    for (const auto& [sensor, rows] : all.back()) names.insert(sensor);
  }
  if (names.erase("") > 0 && !names.empty()) {
    throw StudyError(
        "{}: files with and without a column sensor (which is it?): write it in all or in none",
        EstimateFiles::place(0, 0));
  }
  if (gates) gates->require_sensors({names.begin(), names.end()});
  for (std::size_t c = 0; c < all.size(); ++c) add_parts(c, all[c], gates);
}

InnovationFiles::Sensors InnovationFiles::innovations_of(std::size_t files) const {
  Sensors all;
  for (std::size_t run = 0; run < runs().size(); ++run) {
    for (const auto& [sensor, rows] : innovations_in(EstimateFiles::place(files, run)))
      all[sensor].add(rows);
  }
  return all;
}

void InnovationFiles::add_parts(std::size_t files, const Sensors& sensors,
                                const std::optional<Gates>& gates) {
  const std::string& label = EstimateFiles::cells()[files];
  if (sensors.empty()) {
    labels_.push_back(label);
    parts_.push_back({files, "", std::nullopt, {}});
  }
  for (const auto& [sensor, rows] : sensors) {
    Part part{
        files, sensors.size() < 2 ? "" : sensor, gates ? gates->of(sensor) : std::nullopt, {}};
    labels_.push_back(part.sensor.empty() ? label : formatted("{}.{}", label, sensor));
    if (!part.sensor.empty()) {
      check_label(labels_.back(), "rename the sensor");
      part.settings.emplace_back("sensor", sensor);
    }
    if (part.gate) {
      part.settings.emplace_back("gate", part.gate->text());
      part.settings.emplace_back("gate_limits", rows.limits_of(*part.gate));
    } else if (std::string sign = rows.sign_of_a_gate(sensor); !sign.empty()) {
      signs_of_gates_.push_back(std::move(sign));
    }
    parts_.push_back(std::move(part));
  }
}

std::vector<std::string> InnovationFiles::notes() const {
  std::vector<std::string> notes = EstimateFiles::notes();
  notes.insert(notes.end(), signs_of_gates_.begin(), signs_of_gates_.end());
  return notes;
}

std::vector<double> InnovationFiles::times(std::size_t cell, std::size_t run) const {
  return times_of(place(cell, run)).time;
}

StateRows InnovationFiles::estimates(std::size_t cell, std::size_t run) const {
  StateRows rows = times_of(place(cell, run));
  require_seconds(rows, place(cell, run));
  read_innovations(
      place(cell, run), place(cell, run), 0.0, rows,
      {.sensor = parts_[cell].sensor, .gate = parts_[cell].gate, .with_components = true});
  return rows;
}

}  // namespace montecarta::experiments
