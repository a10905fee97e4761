// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/study_settings.hpp"
#include "engine/records/columns.hpp"
#include "experiments/study/settings.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::experiments {
namespace {

constexpr double kTiny = 1e-6;  // least of what must be positive
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

/// Without a default; `example` is offered as remedy.
Setting required(Setting setting, const char* example) {
  setting.fallback.reset();
  setting.example = example;
  return setting;
}

/// Of these kinds of scenario only.
Setting only_for(std::vector<std::string> kinds, Setting setting) {
  setting.kinds = std::move(kinds);
  return setting;
}

/// A setting of some vehicles.
Setting of_vehicles(const char* section, const Parameter& parameter) {
  Setting setting{parameter, section};
  setting.chooser = "vehicle";
  return setting;
}

/// The deviation of a component of some sensors, from `least` on.
Setting deviation_setting(const char* section, Quantity quantity, double least) {
  Setting setting{component_of(quantity).sigma, section};
  setting.least = least;
  setting.chooser = "sensor";
  setting.applies_to = sensors_with(quantity);
  return setting;
}

/// With another default where the scenario is of that kind.
Setting but_for(const char* kind, const char* fallback, Setting setting) {
  setting.fallback_of_kind.emplace_back(kind, fallback);
  return setting;
}

/// alpha_1 to alpha_4 (EQUATIONS 1), added by `add`.
template <class Add>
void add_growth(const char* section, const Add& add) {
  static constexpr std::array<const char*, 4> kMeanings = {
      "variance of a speed by its square", "and by the square of steering angle or yaw rate",
      "variance of steering angle or yaw rate by the square of the speed", "and by its own square"};
  for (std::size_t i = 0; i < kMeanings.size(); ++i) {
    add(number(section, alpha_key(i).c_str(), "SI", "0", 0, 1e6, kMeanings[i]));
  }
}

/// Which sensor, where it is mounted, and its noise, added by `add`. Deviations from `least` on.
template <class Add>
void add_sensor_kind(const char* section, double least, const Add& add) {
  const auto mount = [&](const char* key, const char* unit, double most, const char* meaning) {
    add(number(section, key, unit, "0", -most, most, meaning), "");
  };
  add(choice(section, "sensor", sensor_names(), "what detects landmarks (EQUATIONS 2)"), "");
  mount("mount_forward", "m", 1000, "of the sensor, ahead of the pose");
  mount("mount_left", "m", 1000, "of the sensor, left of the pose");
  mount("mount_turn_deg", "deg", 360, "where the sensor looks, left of the heading");
  for (const Quantity quantity :
       {Quantity::range, Quantity::bearing, Quantity::forward, Quantity::left}) {
    add(deviation_setting(section, quantity, least), component_of(quantity).sigma.example);
  }
}

void add_drive(std::vector<Setting>& table) {
  const char* s = "scenario";
  const auto add = [&](Setting setting) {
    table.push_back(only_for({"simulated"}, std::move(setting)));
  };
  add(required(text(s, "world", "a shipped world, or a path to a .csv file"), "web_loop"));
  add(count(s, "loops", "1", 1, 10'000, "times round the way-points"));
  add(choice(s, "noise", {"measured-control", "matched"},
             "noise on the controls the filter is given, or on the truth's motion (EQUATIONS 1)"));
  Setting pilot = choice(s, "pilot", {"closed_loop", "open_loop"},
                         "steers by the true pose, or takes the controls of the noise-free drive");
  pilot.chooser = "noise";
  pilot.applies_to = {"matched"};
  add(pilot);
  add(choice(s, "map", {"fixed", "random"},
             "landmarks where the world has them, or displaced anew in every run"));
  add(number(s, "map_shift", "m", "10", 0, 1e4, "farthest that a random map displaces one"));
  add(choice(s, "vehicle", vehicle_names(),
             "what drives, and what its controls are (EQUATIONS 1)"));
  const auto add_all = [&](const std::vector<Parameter>& parameters) {
    for (const Parameter& parameter : parameters) add(of_vehicles(s, parameter));
  };
  add_all(vehicle_parameters(VehicleUse::motion));
  add(number(s, "speed", "m/s", "3", 1e-3, 1000, "along the path; of rear_wheel: of that wheel"));
  add(number(s, "control_rate", "Hz", "40", 1e-3, 1e5, "control steps a second"));
  add(number(s, "scan_rate", "Hz", "5", 1e-4, 1e5, "scans a second; must divide control_rate"));
  add(number(s, "waypoint_radius", "m", "1", 1e-3, 1e4, "nearer than this a way-point is reached"));
  add_all(vehicle_parameters(VehicleUse::pilot));
  add(number(s, "start_x", "m", "0", -1e6, 1e6, "pose before the first step"));
  add(number(s, "start_y", "m", "0", -1e6, 1e6, "pose before the first step"));
  add(number(s, "start_heading_deg", "deg", "0", -360, 360, "pose before the first step"));
  add_all(control_noise_parameters());
  add_growth(s, add);
  add_sensor_kind(s, 0.0, [&](const Setting& setting, const std::string&) { add(setting); });
}

void add_recording(std::vector<Setting>& table) {
  const char* s = "scenario";
  const auto add = [&](Setting setting) { table.push_back(only_for({"log"}, std::move(setting))); };
  add(required(text(s, "path", "the folder of the recorded drive; several, one a run, with commas"),
               "my_drive"));
  add(text(s, "data_sha256", "fingerprint of each drive, filled in"));
  add(text(s, "reference", "the one to judge by; all of them where empty"));
  add(number(s, "scan_delay", "s", "0", -10, 10, "how much later than it was a scan is stamped"));
}

void add_sensor(std::vector<Setting>& table) {
  const char* s = "scenario";
  table.push_back(number(s, "max_range", "m", "30", 1e-3, 1e6, "farther is not detected"));
  table.push_back(number(s, "min_range", "m", "0", 0, 1e6, "nearer is not detected"));
  const auto add = [&](Setting setting) {
    table.push_back(only_for({"simulated"}, std::move(setting)));
  };
  add(number(s, "field_of_view_deg", "deg", "180", 0.1, 360,
             "of the sensor, centred where it looks"));
  add(number(s, "clutter_rate", "1", "0", 0, 100, "mean false alarms a scan"));
  add(number(s, "miss_probability", "1", "0", 0, 1, "that a landmark in view is not detected"));
}

/// In a simulation it follows the scenario. With an `example` it must be given for a recorded
/// drive, of which only the user knows it.
Setting believed(Setting setting, const std::string& example) {
  if (!example.empty()) {
    setting.example = example;
    setting = but_for("log", kRequired, std::move(setting));
  }
  return but_for("simulated", kFromScenario, std::move(setting));
}

void add_scenario(std::vector<Setting>& table) {
  table.push_back(choice("scenario", "kind", {"simulated", "log"}, "where drives come from"));
  add_drive(table);
  add_recording(table);
  add_sensor(table);
}

/// In a simulation everything follows the scenario unless it says otherwise.
void add_belief(std::vector<Setting>& table) {
  const char* s = "belief";
  const char* meaning = "what the filter takes it to be";
  const auto add = [&](Setting setting, const std::string& example = {}) {
    setting.meaning = meaning;
    table.push_back(believed(std::move(setting), example));
  };
  add(choice(s, "vehicle", vehicle_names(), meaning));
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
  table.push_back(required(text(s, "name", "what the study is called"), "my_study"));
  table.push_back(text(s, "title", "one line for figures; the name where empty"));
  table.push_back(count(s, "seed", "1", 0, kMostSeed, "of all random numbers; any will do"));
  table.push_back(required(count(s, "runs", "", 1, 1e7, "repetitions of every cell"), "100"));
  table.push_back(
      text(s, "until",
           "METRIC < HALF-WIDTH, verdict, or verdict, N runs: when a cell stops; else empty"));
  table.push_back(number(s, "within", "1", kUsualWithin, kLeastMargin, kMostMargin,
                         "consistent: squared errors so many times too large or small at most"));
}

/// The fallback gates are chi-square 5.991 (95 %) and 25 with two degrees of freedom.
void add_association(std::vector<Setting>& table) {
  const char* s = "association";
  table.push_back(but_for("log", "nearest",
                          choice(s, "kind", {"known", "nearest"},
                                 "who says which landmark a detection is (EQUATIONS 17)")));
  table.push_back(number(s, "gate_sigma", "sigma", "1.959963984540054", 0.01, 30,
                         "nearer: may be that landmark"));
  table.push_back(number(s, "new_gate_sigma", "sigma", "4.626072265579014", 0.01, 30,
                         "farther from all: a new one"));
  table.push_back(number(s, "log_new_density_offset", "1", "0", -1000, 1000,
                         "added to log p0 of EQUATIONS (17.2)"));
  table.push_back(
      count(s, "most_landmarks", "1000", 1, 100'000, "a larger map has run away: the run fails"));
}

void add_record(std::vector<Setting>& table) {
  const char* s = "record";
  std::vector<std::string> groups;
  for (const ColumnGroup& group : column_groups()) groups.emplace_back(group.name);
  Setting columns = choice(s, "columns", groups, "what is stored");
  columns.kind = Setting::Kind::choices;
  columns.fallback = "pose, covariance, ancestry";
  table.push_back(but_for("log", "pose, covariance, ancestry, final_map", columns));
  table.push_back(but_for("log", "scan",
                          choice(s, "rate", {"control", "scan"},
                                 "store poses at every control step or at scans only")));
  table.push_back(count(s, "map_rows", "0", 0, 100'000,
                        "rows of map columns with unknown association; 0: as many as the world "
                        "has, or most_landmarks"));
  table.push_back(
      count(s, "joint_scans", "16", 1, 100'000, "scans at which the column joint is stored"));
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
