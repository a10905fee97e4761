// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/study_settings.hpp"
#include "engine/records/columns.hpp"
#include "engine/wrapped_text.hpp"
#include "experiments/study/settings.hpp"
#include "experiments/text/words.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::experiments {
namespace {

constexpr double kTiny = 1e-6;  // lower bound of settings that must be positive
constexpr double kMostSeed = 18446744073709551615.0;

Setting text(const char* section, const char* key, const char* meaning) {
  return {{.key = key, .fallback = "", .meaning = meaning}, section};
}

Setting number(const char* section, const char* key, const char* unit, const char* fallback,
               double least, double most, const char* meaning) {
  return {number_parameter(key, fallback, least, most, meaning, unit), section};
}

Setting count(const char* section, const char* key, const char* fallback, double least, double most,
              const char* meaning) {
  return {count_parameter(key, fallback, least, most, meaning), section};
}

/// The first choice is the default.
Setting choice(const char* section, const char* key, std::vector<std::string> choices,
               const char* meaning) {
  const std::string first = choices.front();
  return {choice_parameter(key, first, std::move(choices), meaning), section};
}

/// A setting without default. Errors offer `example` as a remedy.
Setting required(Setting setting, const char* example) {
  setting.fallback.reset();
  setting.example = example;
  return setting;
}

/// A setting for these kinds of scenario only.
Setting only_for(std::vector<std::string> kinds, Setting setting) {
  setting.kinds = std::move(kinds);
  return setting;
}

/// A setting that only some vehicles have.
Setting of_vehicles(const char* section, const Parameter& parameter) {
  Setting setting{parameter, section};
  setting.chooser = "vehicle";
  return setting;
}

/// The deviation of a component that some sensors have, bounded below by `least`.
Setting deviation_setting(const char* section, Quantity quantity, double least) {
  Setting setting{component_of(quantity).sigma, section};
  setting.least = least;
  setting.chooser = "sensor";
  setting.applies_to = sensors_with(quantity);
  return setting;
}

/// Gives a setting another default for one kind of scenario.
Setting but_for(const char* kind, const char* fallback, Setting setting) {
  setting.fallback_of_kind.emplace_back(kind, fallback);
  return setting;
}

/// Adds alpha_1 to alpha_4 (EQUATIONS 1) by calling `add`.
template <class Add>
void add_growth(const char* section, const Add& add) {
  static constexpr std::array<const char*, 4> kMeanings = {
      "variance of the speed per squared speed. Equation (1.10) of EQUATIONS.",
      "variance of the speed per squared steer or yaw_rate. Equation (1.10) of EQUATIONS.",
      "variance of steer or yaw_rate per squared speed. Equation (1.10) of EQUATIONS.",
      "variance of steer or yaw_rate per its own square. Equation (1.10) of EQUATIONS."};
  for (std::size_t i = 0; i < kMeanings.size(); ++i) {
    add(number(section, alpha_key(i).c_str(), "SI", "0", 0, 1e6, kMeanings[i]));
  }
}

/// Adds the kind of sensor, its mounting and its noise. Deviations are bounded below by `least`.
template <class Add>
void add_sensor_kind(const char* section, double least, const Add& add) {
  const auto mount = [&](const char* key, const char* unit, double most, const char* meaning) {
    add(number(section, key, unit, "0", -most, most, meaning), "");
  };
  add(choice(section, "sensor", sensor_names(),
             "sensor that detects landmarks. Its equations are in EQUATIONS 2."),
      "");
  mount("mount_forward", "m", 1000, "position of the sensor ahead of the pose");
  mount("mount_left", "m", 1000, "position of the sensor left of the pose");
  mount("mount_turn_deg", "deg", 360, "direction of the sensor, left of the heading");
  for (const Quantity quantity :
       {Quantity::range, Quantity::bearing, Quantity::forward, Quantity::left}) {
    add(deviation_setting(section, quantity, least), component_of(quantity).sigma.example);
  }
}

/// Adds the course of the vehicle and the variation between runs.
template <class Add>
void add_course(const char* s, const Add& add) {
  add(required(text(s, "world", "name of a shipped world, or path of a .csv file"), "web_loop"));
  add(count(s, "loops", "1", 1, 10'000, "number of loops along the way-points"));
  add(choice(
      s, "noise", {"measured-control", "matched"},
      "where the noise of the controls acts. With measured-control the vehicle moves as commanded "
      "and the filter is given noisy measurements of the controls. With matched the noise "
      "acts on the vehicle, and the filter is given the commanded controls, as filters assume "
      "(EQUATIONS 1)."));
  Setting pilot =
      choice(s, "pilot", {"closed_loop", "open_loop"},
             "whether the pilot sees the true pose. In closed_loop it steers by the true pose. In "
             "open_loop it applies the controls of the noise-free drive, so that the vehicle "
             "strays from the way-points.");
  pilot.chooser = "noise";
  pilot.applies_to = {"matched"};
  add(pilot);
  add(choice(
      s, "map", {"fixed", "random"},
      "whether landmarks are displaced in every run. With fixed they are where the world has them. "
      "With random every run displaces each of them uniformly within map_shift."));
  add(number(s, "map_shift", "m", "10", 0, 1e4,
             "largest displacement of a landmark of a random map"));
}

void add_drive(std::vector<Setting>& table) {
  const char* s = "scenario";
  const auto add = [&](Setting setting) {
    table.push_back(only_for({"simulated"}, std::move(setting)));
  };
  add_course(s, add);
  add(choice(s, "vehicle", vehicle_names(),
             "kind of vehicle, which decides its controls. The motion models are in EQUATIONS 1."));
  const auto add_all = [&](const std::vector<Parameter>& parameters) {
    for (const Parameter& parameter : parameters) add(of_vehicles(s, parameter));
  };
  add_all(vehicle_parameters(VehicleUse::motion));
  add(number(s, "speed", "m/s", "3", 1e-3, 1000,
             "speed along the path. With vehicle = rear_wheel it is the speed of that wheel."));
  add(number(s, "control_rate", "Hz", "40", 1e-3, 1e5, "control steps per second"));
  add(number(s, "scan_rate", "Hz", "5", 1e-4, 1e5, "scans per second; must divide control_rate"));
  add(number(s, "waypoint_radius", "m", "1", 1e-3, 1e4,
             "distance at which a way-point counts as reached"));
  add_all(vehicle_parameters(VehicleUse::pilot));
  add(number(s, "start_x", "m", "0", -1e6, 1e6, "x before the first step"));
  add(number(s, "start_y", "m", "0", -1e6, 1e6, "y before the first step"));
  add(number(s, "start_heading_deg", "deg", "0", -360, 360, "heading before the first step"));
  add_all(control_noise_parameters());
  add_growth(s, add);
  add_sensor_kind(s, 0.0, [&](const Setting& setting, const std::string&) { add(setting); });
}

void add_recording(std::vector<Setting>& table) {
  const char* s = "scenario";
  const auto add = [&](Setting setting) { table.push_back(only_for({"log"}, std::move(setting))); };
  add(required(
      text(s, "path",
           "folder of the recorded drive. With several folders, separated by commas, run k uses "
           "drive k."),
      "my_drive"));
  add(text(s, "data_sha256", "fingerprint of each drive, which montecarta fills in"));
  add(text(s, "reference", "reference for the errors; all references if empty"));
  add(number(
      s, "scan_delay", "s", "0", -10, 10,
      "delay of the time stamps of the scans. A scan is taken this long before its time stamp."));
}

void add_sensor(std::vector<Setting>& table) {
  const char* s = "scenario";
  table.push_back(number(s, "max_range", "m", "30", 1e-3, 1e6, "largest range of a detection"));
  table.push_back(number(s, "min_range", "m", "0", 0, 1e6, "smallest range of a detection"));
  const auto add = [&](Setting setting) {
    table.push_back(only_for({"simulated"}, std::move(setting)));
  };
  add(number(s, "field_of_view_deg", "deg", "180", 0.1, 360,
             "field of view, centred on the sensor's direction"));
  add(number(s, "clutter_rate", "1", "0", 0, 100, "mean number of false alarms per scan"));
  add(number(s, "miss_probability", "1", "0", 0, 1,
             "probability that a landmark in view is missed"));
}

/// A setting of [belief], which in a simulation defaults to that of [scenario]. With an `example`
/// it must be given for a recorded drive, for which only the user knows it.
Setting believed(Setting setting, const std::string& example) {
  if (!example.empty()) {
    setting.example = example;
    setting = but_for("log", kRequired, std::move(setting));
  }
  return but_for("simulated", kFromScenario, std::move(setting));
}

void add_scenario(std::vector<Setting>& table) {
  table.push_back(choice("scenario", "kind", {"simulated", "log"},
                         "whether drives are simulated, or recorded in a log"));
  add_drive(table);
  add_recording(table);
  add_sensor(table);
}

/// Adds [belief]. In a simulation all settings default to those of [scenario].
void add_belief(std::vector<Setting>& table) {
  const char* s = "belief";
  const auto add = [&](Setting setting, const std::string& example = {}) {
    setting.meaning = engine::first_sentence(setting.meaning) +
                      ". This is the value that the filters assume. The true one is that of "
                      "[scenario].";
    table.push_back(believed(std::move(setting), example));
  };
  add(choice(s, "vehicle", vehicle_names(), "kind of vehicle"));
  for (const Parameter& parameter : vehicle_parameters(VehicleUse::motion)) {
    add(of_vehicles(s, parameter), parameter.example);
  }
  for (const Parameter& parameter : control_noise_parameters()) {
    add(of_vehicles(s, parameter), parameter.example);
  }
  add_growth(s, add);
  add_sensor_kind(s, kTiny, add);
}

void add_study(std::vector<Setting>& table) {
  const char* s = "study";
  table.push_back(
      required(text(s, "name", "name of the study and of its result file"), "my_study"));
  table.push_back(text(s, "title", "title of the figures; the name if empty"));
  table.push_back(count(s, "seed", "1", 0, kMostSeed, "seed of all random numbers"));
  table.push_back(required(count(s, "runs", "", 1, 1e7, "number of runs of every cell"), "100"));
  table.push_back(text(
      s, "until",
      "when a cell stops before its last run; never if empty. With METRIC < HALF-WIDTH it stops "
      "when the 95 % interval of the mean of that metric is within +- the half-width. With "
      "verdict it stops when it is shown to be consistent, after 300 runs at the earliest, or not "
      "to be consistent. With verdict, N runs this is after N runs instead of 300."));
  table.push_back(
      number(s, "within", "1", kUsualWithin, kLeastMargin, kMostMargin,
             "factor within which the NEES counts as consistent. A filter is consistent if its "
             "squared errors are shown to be too large or too small by this factor at "
             "most."));
}

/// The default gates are chi-square 5.991 (95 %) and 25 with two degrees of freedom.
void add_association(std::vector<Setting>& table) {
  const char* s = "association";
  table.push_back(but_for(
      "log", "nearest",
      choice(s, "kind", {"known", "nearest"},
             "whether the filter is given the associations. With known it is given the landmark of "
             "every detection. With nearest it associates detections with "
             "landmarks itself (EQUATIONS 17).")));
  table.push_back(number(
      s, "gate_sigma", "sigma", "1.959963984540054", 0.01, 30,
      "gate within which a detection may belong to a landmark. It has the probability of this many "
      "standard deviations of a normal distribution (EQUATIONS 17)."));
  table.push_back(number(s, "new_gate_sigma", "sigma", "4.626072265579014", 0.01, 30,
                         "gate beyond which a detection belongs to a new landmark. It has the "
                         "probability of this many standard deviations of a normal distribution "
                         "(EQUATIONS 17)."));
  table.push_back(number(
      s, "log_new_density_offset", "1", "0", -1000, 1000,
      "added to the log density of a new landmark. The log density is that of EQUATIONS (17.2)."));
  table.push_back(count(s, "most_landmarks", "1000", 1, 100'000,
                        "number of landmarks in a map beyond which a run fails"));
}

void add_record(std::vector<Setting>& table) {
  const char* s = "record";
  std::vector<std::string> groups;
  for (const ColumnGroup& group : column_groups()) groups.emplace_back(group.name);
  Setting columns =
      choice(s, "columns", groups,
             "columns that are stored. They are explained by: montecarta list columns");
  columns.kind = Setting::Kind::choices;
  columns.fallback = "pose, covariance, ancestry";
  table.push_back(but_for("log", "pose, covariance, ancestry, final_map", columns));
  table.push_back(
      count(s, "full_runs", "0", 0, 1e7,
            "number of first runs for which particles, ancestry and maps are stored too"));
  table.push_back(but_for("log", "scan",
                          choice(s, "rate", {"control", "scan"},
                                 "whether poses are stored at control steps or scans")));
  table.push_back(
      count(s, "map_rows", "0", 0, 100'000,
            "rows of the map's columns with unknown association. With 0 it is the number of "
            "landmarks of a simulated world, and most_landmarks for a recorded drive."));
  table.push_back(count(s, "joint_scans", "16", 1, 100'000,
                        "number of scans at which the column joint is stored"));
}

std::vector<Setting> make_table() {
  std::vector<Setting> table;
  add_study(table);
  add_scenario(table);
  add_belief(table);
  add_association(table);
  add_record(table);
  return table;
}

}  // namespace

std::span<const Setting> study_settings() {
  static const std::vector<Setting> table = make_table();
  return table;
}

}  // namespace montecarta::experiments
