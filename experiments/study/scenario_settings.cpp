// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/setting_builders.hpp"

namespace montecarta::experiments::setting_builders {
namespace {

const std::vector<std::string> kVehicles = {"front_axle", "rear_wheel"};

void add_drive(std::vector<Setting>& table) {
  const char* s = "scenario";
  const auto add = [&](Setting setting) {
    table.push_back(only_for({"simulated"}, std::move(setting)));
  };
  add(required(text(s, "world", "a shipped world, or a path to .csv or .mat with lm and wp"),
               "web_loop"));
  add(count(s, "loops", "1", 1, 10'000, "times round the way-points"));
  add(choice(s, "noise", {"measured-control", "matched"},
             "noise on the controls the filter is given, or on the truth's motion (EQUATIONS 1)"));
  add(choice(s, "map", {"fixed", "random"},
             "landmarks where the world has them, or displaced anew in every run"));
  add(number(s, "map_shift", "m", "10", 0, 1e4, "farthest that a random map displaces one"));
  add(choice(s, "vehicle", kVehicles,
             "pose and speed of the middle of the front axle, or pose of the sensor and speed of a "
             "rear wheel (EQUATIONS 1)"));
  add(number(s, "wheelbase", "m", "4", 1e-3, 1000, "between the axles"));
  add(number(s, "wheel_left", "m", "0", -1000, 1000, "measured rear wheel left of the middle"));
  add(number(s, "sensor_ahead", "m", "0", -1000, 1000, "sensor ahead of the rear axle"));
  add(number(s, "sensor_left", "m", "0", -1000, 1000, "sensor left of the middle"));
  add(number(s, "speed", "m/s", "3", 1e-3, 1000, "of the front axle, or of the rear wheel"));
  add(number(s, "control_rate", "Hz", "40", 1e-3, 1e5, "control steps a second"));
  add(number(s, "scan_rate", "Hz", "5", 1e-4, 1e5, "scans a second; must divide control_rate"));
  add(number(s, "waypoint_radius", "m", "1", 1e-3, 1e4, "nearer than this a way-point is reached"));
  add(number(s, "steer_limit_deg", "deg", "30", 0.1, 89, "largest steering angle"));
  add(number(s, "steer_rate_limit_deg", "deg/s", "20", 0.1, 1e5, "fastest turn of the steering"));
  add(number(s, "start_x", "m", "0", -1e6, 1e6, "pose before the first step"));
  add(number(s, "start_y", "m", "0", -1e6, 1e6, "pose before the first step"));
  add(number(s, "start_heading_deg", "deg", "0", -360, 360, "pose before the first step"));
  add(number(s, "sigma_speed", "m/s", "0.3", 0, 1000, "noise of the speed"));
  add(number(s, "sigma_steer_deg", "deg", "3", 0, 180, "noise of the steering angle"));
  add(number(s, "sigma_range", "m", "0.1", 0, 1000, "noise of a range"));
  add(number(s, "sigma_bearing_deg", "deg", "1", 0, 180, "noise of a bearing"));
}

void add_recording(std::vector<Setting>& table) {
  const char* s = "scenario";
  table.push_back(only_for(recorded_kinds(),
                           required(text(s, "path", "the folder that holds the recorded drive"),
                                    "../shared/data/victoria_park")));
  table.push_back(
      only_for(recorded_kinds(), text(s, "data_sha256", "fingerprint of the drive, filled in")));
  table.push_back(only_for(recorded_kinds(),
                           text(s, "reference", "the one to judge by; all of them where empty")));
  table.push_back(only_for(
      recorded_kinds(),
      number(s, "scan_delay", "s", "0", -10, 10, "how much later than it was a scan is stamped")));
  table.push_back(only_for({"victoria_park"}, choice(s, "steering", {"calibrated", "raw"},
                                                     "of the text release, or as measured")));
}

void add_sensor(std::vector<Setting>& table) {
  const char* s = "scenario";
  table.push_back(number(s, "max_range", "m", "30", 1e-3, 1e6, "farther is not detected"));
  const auto add = [&](Setting setting) {
    table.push_back(only_for({"simulated"}, std::move(setting)));
  };
  add(number(s, "field_of_view_deg", "deg", "180", 0.1, 360, "of the sensor, centred ahead"));
  add(number(s, "clutter_rate", "1", "0", 0, 100, "mean false alarms a scan"));
  add(number(s, "miss_probability", "1", "0", 0, 1, "that a landmark in view is not detected"));
}

/// With defaults for the two published drives, whose vehicle is one.
Setting of_car(Setting setting, const char* value) {
  return but_for("victoria_park", value, but_for("car_park", value, std::move(setting)));
}

/// Follows the scenario in a simulation; of a drive of the user's own nobody else knows it.
Setting of_own_log(Setting setting, const char* example) {
  setting.example = example;
  return but_for("simulated", kFromScenario, but_for("log", kRequired, std::move(setting)));
}

}  // namespace

void add_scenario(std::vector<Setting>& table) {
  std::vector<std::string> kinds = recorded_kinds();
  kinds.insert(kinds.begin(), "simulated");
  table.push_back(choice("scenario", "kind", kinds, "where drives come from"));
  add_drive(table);
  add_recording(table);
  add_sensor(table);
}

/// In a simulation everything follows the scenario unless it says otherwise.
void add_belief(std::vector<Setting>& table) {
  const char* s = "belief";
  const auto add = [&](const char* value, Setting setting) {
    table.push_back(of_car(but_for("simulated", kFromScenario, std::move(setting)), value));
  };
  const char* meaning = "what the filter takes it to be";
  add("rear_wheel", choice(s, "vehicle", kVehicles, meaning));
  table.push_back(
      of_car(of_own_log(number(s, "wheelbase", "m", "4", 1e-3, 1000, meaning), "2.83"), "2.83"));
  add("0.76", number(s, "wheel_left", "m", "0", -1000, 1000, meaning));
  add("3.78", number(s, "sensor_ahead", "m", "0", -1000, 1000, meaning));
  add("0.5", number(s, "sensor_left", "m", "0", -1000, 1000, meaning));
  // Victoria Park: Ankishan 2016, Simulation IV. Car park: what is customary there.
  const auto noise = [&](const char* park, const char* car_park, Setting setting) {
    table.push_back(but_for("victoria_park", park,
                            but_for("car_park", car_park, of_own_log(std::move(setting), park))));
  };
  noise("0.4", "0.7", number(s, "sigma_speed", "m/s", "0.3", 0, 1000, meaning));
  noise("1.4", "7", number(s, "sigma_steer_deg", "deg", "3", 0, 180, meaning));
  noise("0.5", "0.1", number(s, "sigma_range", "m", "0.1", kTiny, 1000, meaning));
  noise("1.5", "1", number(s, "sigma_bearing_deg", "deg", "1", kTiny, 180, meaning));
}

}  // namespace montecarta::experiments::setting_builders
