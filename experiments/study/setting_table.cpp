// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/setting_table.hpp"

#include "engine/core/judgement.hpp"
#include "engine/formatted.hpp"
#include "engine/records/columns.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/wrapped_text.hpp"
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

/// Adds the settings of one section to the table, for some kinds of scenario or for all.
class SectionOfTable {
 public:
  SectionOfTable(const char* name, std::vector<Setting>& table, std::vector<std::string> kinds = {})
      : name_(name), kinds_(std::move(kinds)), table_(table) {}

  // Each function returns the setting, so that the caller can change it before the next one is
  // added.
  Setting& add(const Parameter& parameter) const {
    return table_.emplace_back(Setting{parameter, name_, {{"scenario", "kind", kinds_}}});
  }
  Setting& text(const char* key, const char* meaning) const {
    return add({.key = key, .fallback = "", .meaning = meaning});
  }
  Setting& number(const char* key, const char* unit, const char* fallback, double least,
                  double most, const char* meaning) const {
    return add(number_parameter(key, fallback, least, most, meaning, unit));
  }
  Setting& count(const char* key, const char* fallback, double least, double most,
                 const char* meaning) const {
    return add(count_parameter(key, fallback, least, most, meaning));
  }
  /// Adds a setting with choices, of which the first is the default.
  Setting& choice(const char* key, const std::vector<std::string>& choices,
                  const char* meaning) const {
    return add(choice_parameter(key, choices.front(), choices, meaning));
  }
  /// Adds settings that only some vehicles have.
  void add_for_vehicles(const std::vector<Parameter>& parameters) const {
    for (const Parameter& parameter : parameters)
      only_if(add(parameter), "vehicle", parameter.applies_to);
  }

  /// Restricts a setting to some values of an earlier one of its section.
  void only_if(Setting& setting, const char* key, const std::vector<std::string>& values) const {
    setting.conditions.push_back({name_, key, values});
  }

 private:
  std::string name_;
  std::vector<std::string> kinds_;
  std::vector<Setting>& table_;
};

/// Removes the default. Errors offer `example` as a remedy.
void require(Setting& setting, const char* example) {
  setting.fallback.reset();
  setting.example = example;
}

/// Gives a setting another default for recorded drives.
void set_for_log(Setting& setting, const char* fallback) {
  setting.other_fallbacks.push_back({"scenario", "kind", "log", fallback});
}

/// Adds alpha_1 to alpha_4 (EQUATIONS 1).
void add_growth(const SectionOfTable& section) {
  static constexpr std::array<const char*, 4> kMeanings = {
      "variance of the speed per squared speed. Equation (1.10) of EQUATIONS.",
      "variance of the speed per squared steer or yaw_rate. Equation (1.10) of EQUATIONS.",
      "variance of steer or yaw_rate per squared speed. Equation (1.10) of EQUATIONS.",
      "variance of steer or yaw_rate per its own square. Equation (1.10) of EQUATIONS."};
  for (std::size_t i = 0; i < kMeanings.size(); ++i)
    section.number(alpha_key(i).c_str(), "SI", "0", 0, 1e6, kMeanings[i]);
}

/// Adds the noise of a step besides that of its controls (EQUATIONS 1).
void add_increment_noise(const SectionOfTable& section, bool needs_matched) {
  Setting& model = section.choice(
      "increment_noise", {kIncrementNames.begin(), kIncrementNames.end()},
      "noise of a step besides that of its controls. With additive the displacement forward and to "
      "the left and the turn have independent noise. With odometry the rotation, translation and "
      "rotation of a step have (Thrun, Burgard, Fox: Probabilistic Robotics, table 5.6).");
  if (needs_matched) section.only_if(model, "noise", {"matched"});
  static constexpr std::array<const char*, 3> kOf = {"displacement forward",
                                                     "displacement to the "
                                                     "left",
                                                     "turn"};
  for (std::size_t i = 0; i < kIncrementKeys.size(); ++i) {
    const std::string meaning = formatted(
        "standard deviation of the {} after one second. Equation (1.11) of EQUATIONS.", kOf[i]);
    const char* const unit = i < 2 ? "m/s^0.5" : "deg/s^0.5";
    section.only_if(section.number(kIncrementKeys[i], unit, "0", 0, 1e6, meaning.c_str()),
                    "increment_noise", {"additive"});
  }
  static constexpr std::array<const char*, 4> kMeanings = {
      "variance of a rotation per its own square. Equation (1.12) of EQUATIONS.",
      "variance of a rotation per squared translation. Equation (1.12) of EQUATIONS.",
      "variance of the translation per its own square. Equation (1.12) of EQUATIONS.",
      "variance of the translation per squared rotations. Equation (1.12) of EQUATIONS."};
  for (std::size_t i = 0; i < kMeanings.size(); ++i) {
    section.only_if(section.number(odometry_key(i).c_str(), "SI", "0", 0, 1e6, kMeanings[i]),
                    "increment_noise", {"odometry"});
  }
}

/// Adds the kind of sensor, its mounting and its noise. Deviations are bounded below by `least`.
void add_sensor_kind(const SectionOfTable& section, double least) {
  section.choice("sensor", sensor_names(),
                 "sensor that detects landmarks. Its equations are in EQUATIONS 2.");
  section.number("mount_forward", "m", "0", -1000, 1000,
                 "position of the sensor ahead of the pose");
  section.number("mount_left", "m", "0", -1000, 1000, "position of the sensor left of the pose");
  section.number("mount_turn_deg", "deg", "0", -360, 360,
                 "direction of the sensor, left of the heading");
  for (const Quantity quantity :
       {Quantity::range, Quantity::bearing, Quantity::forward, Quantity::left}) {
    Setting& deviation = section.add(component_of(quantity).sigma);
    deviation.least = least;
    section.only_if(deviation, "sensor", sensors_with(quantity));
  }
}

/// Adds the deviation of a known map and those of the start.
void add_map_deviation(const SectionOfTable& section) {
  section.number("map_sigma_m", "m", "0", 0, 1000,
                 "standard deviation of a known landmark, in x and in y. Every run draws the "
                 "errors of the map that the filters are given, if belief.map = known.");
}
void add_start_deviations(const SectionOfTable& section) {
  section.number("start_sigma_m", "m", "0", 0, 1e6,
                 "standard deviation of the start, in x and in y. Every run draws the error of the "
                 "start that the filters are given, if belief.map = known.");
  section.number("start_sigma_deg", "deg", "0", 0, 180,
                 "standard deviation of the heading at the start. Every run draws the error of the "
                 "heading that the filters are given, if belief.map = known.");
}

/// Adds the course of the vehicle and the variation between runs.
void add_course(const SectionOfTable& scenario) {
  require(scenario.text("world", "name of a shipped world, or path of a .csv file"), "web_loop");
  scenario.count("loops", "1", 1, 10'000, "number of loops along the way-points");
  scenario.choice(
      "noise", {"measured-control", "matched"},
      "where the noise of the controls acts. With measured-control the vehicle moves as commanded "
      "and the filter is given noisy measurements of the controls. With matched the noise "
      "acts on the vehicle, and the filter is given the commanded controls, as filters assume "
      "(EQUATIONS 1).");
  scenario.choice(
      "pilot", {"closed_loop", "open_loop", "constant"},
      "how the vehicle is controlled. In closed_loop the pilot steers by the true pose. In "
      "open_loop, only with noise = matched, it applies the controls of the noise-free drive, so "
      "that the vehicle strays from the way-points. With constant the controls are held for "
      "drive_time, in a circle or straight on, and way-points and loops have no effect.");
  scenario.choice(
      "map", {"fixed", "random"},
      "whether landmarks are displaced in every run. With fixed they are where the world has them. "
      "With random every run displaces each of them uniformly within map_shift.");
  scenario.number("map_shift", "m", "10", 0, 1e4,
                  "largest displacement of a landmark of a random map");
  add_map_deviation(scenario);
}

/// Adds the controls that are held if pilot = constant.
void add_constant_controls(const SectionOfTable& scenario) {
  const std::vector<std::string> constant{"constant"};
  scenario.only_if(scenario.number("drive_time", "s", "60", 1e-3, 1e7, "duration of the drive"),
                   "pilot", constant);
  Setting& steer = scenario.number("constant_steer_deg", "deg", "0", -89, 89,
                                   "steering angle that is held; positive to the left");
  scenario.only_if(steer, "pilot", constant);
  scenario.only_if(steer, "vehicle", {"front_axle", "rear_wheel"});
  Setting& yaw_rate = scenario.number("constant_yaw_rate_deg", "deg/s", "0", -5700, 5700,
                                      "yaw rate that is held; positive to the left");
  scenario.only_if(yaw_rate, "pilot", constant);
  scenario.only_if(yaw_rate, "vehicle", {"differential_drive", "omnidirectional"});
}

void add_drive(const SectionOfTable& scenario) {
  add_course(scenario);
  scenario.choice(
      "vehicle", vehicle_names(),
      "kind of vehicle, which decides its controls. The motion models are in EQUATIONS 1.");
  scenario.add_for_vehicles(vehicle_parameters(VehicleUse::motion));
  scenario.number("speed", "m/s", "3", 1e-3, 1000,
                  "speed along the path. With vehicle = rear_wheel it is the speed of that wheel.");
  scenario.number("control_rate", "Hz", "40", 1e-3, 1e5, "control steps per second");
  scenario.number("scan_rate", "Hz", "5", 1e-4, 1e5, "scans per second; must divide control_rate");
  scenario.number("waypoint_radius", "m", "1", 1e-3, 1e4,
                  "distance at which a way-point counts as reached");
  scenario.add_for_vehicles(vehicle_parameters(VehicleUse::pilot));
  add_constant_controls(scenario);
  scenario.number("start_x", "m", "0", -1e6, 1e6, "x before the first step");
  scenario.number("start_y", "m", "0", -1e6, 1e6, "y before the first step");
  scenario.number("start_heading_deg", "deg", "0", -360, 360, "heading before the first step");
  add_start_deviations(scenario);
  scenario.add_for_vehicles(control_noise_parameters());
  add_growth(scenario);
  add_increment_noise(scenario, true);
  add_sensor_kind(scenario, 0.0);
}

void add_recording(const SectionOfTable& scenario) {
  require(scenario.text("path",
                        "folder of the recorded drive. With several folders, separated by commas, "
                        "run k uses drive k."),
          "my_drive");
  scenario.text("data_sha256", "fingerprint of each drive, which montecarta fills in");
  scenario.text("reference", "reference for the errors; all references if empty");
  scenario.number(
      "scan_delay", "s", "0", -10, 10,
      "delay of the time stamps of the scans. A scan is taken this long before its time stamp.");
}

/// Adds the sensor of the position. It is believed as it is but for its deviation.
void add_fixes(const SectionOfTable& scenario) {
  scenario.choice("fixes", {"none", "position"},
                  "measurements beside the detections of landmarks. With position the filters are "
                  "given fixes of the position of the vehicle in the world, for instance of a "
                  "satellite receiver.");
  scenario.only_if(
      scenario.number("fix_rate", "Hz", "1", 1e-4, 1e5, "fixes per second; must divide scan_rate"),
      "fixes", {"position"});
}
void add_fix_deviation(const SectionOfTable& section, double least) {
  Setting& sigma = section.number("sigma_fix", "m", "1", least, 1e6,
                                  "standard deviation of a fix of the position, in x and in y");
  sigma.conditions.push_back({"scenario", "fixes", {"position"}});
}

void add_scenario(std::vector<Setting>& table) {
  const SectionOfTable scenario("scenario", table), simulated("scenario", table, {"simulated"});
  scenario.choice("kind", {"simulated", "log"},
                  "whether drives are simulated, or recorded in a log");
  add_drive(simulated);
  add_recording(SectionOfTable("scenario", table, {"log"}));
  scenario.number("max_range", "m", "30", 1e-3, 1e6, "largest range of a detection");
  scenario.number("min_range", "m", "0", 0, 1e6, "smallest range of a detection");
  simulated.number("field_of_view_deg", "deg", "180", 0.1, 360,
                   "field of view, centred on the sensor's direction");
  simulated.number("clutter_rate", "1", "0", 0, 100, "mean number of false alarms per scan");
  simulated.number("miss_probability", "1", "0", 0, 1,
                   "probability that a landmark in view is missed");
  add_fixes(simulated);
  add_fix_deviation(simulated, 0.0);
}

/// Makes a setting of [belief] default to that of [scenario] in a simulation. A setting with an
/// example must be given for a recorded drive, for which only the user knows it.
void follow_scenario(Setting& setting) {
  setting.meaning = engine::first_sentence(setting.meaning) +
                    ". This is the value that the filters assume. The true one is that of "
                    "[scenario].";
  if (!setting.example.empty()) set_for_log(setting, kRequired);
  setting.other_fallbacks.push_back({"scenario", "kind", "simulated", kFromScenario});
}

/// Adds what filters know at the start.
void add_prior(const SectionOfTable& belief, std::vector<Setting>& table) {
  belief.choice(
      "map", {"estimated", "known"},
      "whether filters estimate the map (SLAM) or are given it (localisation). With known they are "
      "given the position of every landmark, with errors of map_sigma_m, and never initialise one, "
      "so that new_gate_sigma and most_landmarks have no effect.");
  const std::size_t first = table.size();
  add_map_deviation(belief);
  add_start_deviations(belief);
  for (Setting& setting : std::span(table).subspan(first)) {
    follow_scenario(setting);
    belief.only_if(setting, "map", {"known"});
  }
}

void add_belief(std::vector<Setting>& table) {
  const std::size_t first = table.size();
  const SectionOfTable belief("belief", table);
  belief.choice("vehicle", vehicle_names(), "kind of vehicle");
  belief.add_for_vehicles(vehicle_parameters(VehicleUse::motion));
  belief.add_for_vehicles(control_noise_parameters());
  add_growth(belief);
  add_increment_noise(belief, false);
  add_sensor_kind(belief, kTiny);
  add_fix_deviation({"belief", table, {"simulated"}}, kTiny);
  for (Setting& setting : std::span(table).subspan(first)) follow_scenario(setting);
  add_prior(belief, table);
}

void add_study(const SectionOfTable& study) {
  require(study.text("name", "name of the study and of its result file"), "my_study");
  study.text("title", "title of the figures; the name if empty");
  study.count("seed", "1", 0, kMostSeed, "seed of all random numbers");
  require(study.count("runs", "", 1, 1e7, "number of runs of every cell"), "100");
  study.text(
      "until",
      "when a cell stops before its last run; never if empty. With METRIC < HALF-WIDTH it stops "
      "when the 95 % interval of the mean of that metric is within +- the half-width. With "
      "verdict it stops when it is shown to be consistent, after 300 runs at the earliest, or not "
      "to be consistent. With verdict, N runs this is after N runs instead of 300.");
  study.number("within", "1", kUsualMarginText, kLeastMargin, kMostMargin,
               "factor within which the NEES counts as consistent. A filter is consistent if its "
               "squared errors are shown to be too large or too small by this factor at "
               "most.");
  study.number("judge_from", "s", "0", 0, 1e9,
               "time from which scans are judged. Verdicts, tables and figures over runs leave out "
               "earlier scans, for a filter that first has to converge.");
}

/// The default gates are chi-square 5.991 (95 %) and 25 with two degrees of freedom.
void add_association(const SectionOfTable& association) {
  set_for_log(
      association.choice(
          "kind", {"known", "nearest"},
          "whether the filter is given the associations. With known it is given the landmark of "
          "every detection. With nearest it associates detections with landmarks itself "
          "(EQUATIONS 17)."),
      "nearest");
  association.number(
      "gate_sigma", "sigma", "1.959963984540054", 0.01, 30,
      "gate within which a detection may belong to a landmark. It has the probability of this many "
      "standard deviations of a normal distribution (EQUATIONS 17).");
  association.number(
      "new_gate_sigma", "sigma", "4.626072265579014", 0.01, 30,
      "gate beyond which a detection belongs to a new landmark. It has the probability of this "
      "many standard deviations of a normal distribution (EQUATIONS 17).");
  association.number(
      "log_new_density_offset", "1", "0", -1000, 1000,
      "added to the log density of a new landmark. The log density is that of EQUATIONS (17.2).");
  association.count("most_landmarks", "1000", 1, 100'000,
                    "number of landmarks in a map beyond which a run fails");
}

void add_record(const SectionOfTable& record) {
  std::vector<std::string> groups;
  for (const ColumnGroup& group : column_groups()) groups.emplace_back(group.name);
  Setting& columns = record.choice(
      "columns", groups,
      "columns that are stored, or sums over runs in place of them. They are explained by: "
      "montecarta list columns");
  columns.kind = Setting::Kind::choices;
  columns.fallback = "pose, covariance, ancestry";
  set_for_log(columns, "pose, covariance, ancestry, final_map");
  record.count("full_runs", "0", 0, 1e7,
               "number of first runs for which particles, ancestry and maps are stored too");
  Setting& rate = record.choice("rate", {"control", "scan"},
                                "whether poses are stored at control steps or scans");
  set_for_log(rate, "scan");
  rate.other_fallbacks.push_back(
      {"record", "columns", "sums", "scan"});  // scans are what is added up
  record.count("map_rows", "0", 0, 100'000,
               "rows of the map's columns with unknown association. With 0 it is the number of "
               "landmarks of a simulated world, and most_landmarks for a recorded drive.");
  record.count("joint_scans", "16", 1, 100'000,
               "number of scans at which the column joint is stored");
}

std::vector<Setting> make_table() {
  std::vector<Setting> table;
  add_study({"study", table});
  add_scenario(table);
  add_belief(table);
  add_association({"association", table});
  add_record({"record", table});
  return table;
}

}  // namespace

std::span<const Setting> study_settings() {
  static const std::vector<Setting> table = make_table();
  return table;
}

std::string sections_with(std::string_view key) {
  std::vector<std::string> sections;
  for (const Setting& setting : study_settings()) {
    if (setting.key == key) sections.push_back("[" + setting.section + "]");
  }
  return joined(sections, " or ");
}

}  // namespace montecarta::experiments
