// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/refuse_sensors.hpp"

#include "engine/errors.hpp"
#include "experiments/external/external_kind.hpp"
#include "experiments/study/make_drives.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>

namespace montecarta::experiments {
namespace {

std::string filters_for(const std::string& sensor) {
  std::vector<std::string> names;
  for (const FilterKind& kind : known_filters()) {
    if (kind.sensors.empty() || std::ranges::find(kind.sensors, sensor) != kind.sensors.end())
      names.push_back(kind.name);
  }
  return joined(names);
}

void refuse_kind(const Settings& settings, const CellSpec& cell) {
  const std::vector<std::string>& taken = cell.filter->sensors;
  const std::string& sensor = settings.text("belief", "sensor");
  if (taken.empty() || std::ranges::find(taken, sensor) != taken.end()) return;
  throw StudyError(cell.place + ": " + cell.filter->name + " takes no sensor " + sensor +
                   " (it takes " + joined(taken) + "): use one of " + filters_for(sensor) +
                   ", or another sensor in [scenario] or [belief]");
}

void refuse_mounting(const CellSpec& cell, const Sensor& sensor) {
  if (cell.filter->sensors.empty() || sensor.mounting.is_none()) return;
  throw StudyError(cell.place + ": " + cell.filter->name +
                   " takes no sensor that is mounted elsewhere than at the pose (mount_forward, "
                   "mount_left, mount_turn_deg): set these to 0, or use one of " +
                   filters_for(name_of(sensor)));
}

void refuse_association(const Settings& settings, const CellSpec& cell, const Sensor& sensor) {
  if (settings.text("association", "kind") == "known") return;
  const bool takes_listed_sensors = !cell.filter->sensors.empty();
  if (takes_listed_sensors && !std::holds_alternative<RangeBearingSensor>(sensor.kind)) {
    throw StudyError(settings.place("association", "kind") + ": association.kind = nearest with " +
                     name_of(sensor) + " (" + cell.filter->name +
                     " takes it where identities are known): set association.kind = known");
  }
  if (!cell.filter->delays_initialisation || fixes_landmark(sensor)) return;
  throw StudyError(settings.place("association", "kind") + ": association.kind = nearest with " +
                   name_of(sensor) + " (one detection does not say where a landmark is, so that " +
                   cell.filter->name +
                   " cannot tell which one it is of): set association.kind = known");
}

}  // namespace

void refuse_sensors(const Settings& settings, std::span<const CellSpec> cells) {
  const Sensor sensor = sensor_of(settings, "belief");
  for (const CellSpec& cell : cells) {
    refuse_kind(settings, cell);
    refuse_mounting(cell, sensor);
    refuse_association(settings, cell, sensor);
  }
}

}  // namespace montecarta::experiments
