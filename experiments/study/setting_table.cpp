// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/setting.hpp"

namespace montecarta {
namespace {

using Kind = Setting::Kind;

constexpr double kTiny = 1e-6;  // least of what must be positive
constexpr double kMostSeed = 18446744073709551615.0;

Setting number(const char* section, const char* key, const char* unit, const char* fallback,
               double least, double most, const char* meaning) {
  return {section, key, Kind::number, unit, fallback, least, most, {}, meaning, {}};
}

Setting count(const char* section, const char* key, const char* fallback, double least, double most,
              const char* meaning) {
  return {section, key, Kind::count, "", fallback, least, most, {}, meaning, {}};
}

Setting choice(const char* section, const char* key, std::vector<std::string> choices,
               const char* meaning) {
  const std::string first = choices.front();
  return {section, key, Kind::choice, "", first, 0.0, 0.0, std::move(choices), meaning, {}};
}

void add_study(std::vector<Setting>& table) {
  table.push_back({"study",
                   "name",
                   Kind::text,
                   "",
                   std::nullopt,
                   0,
                   0,
                   {},
                   "what the study is called",
                   "my_study"});
  table.push_back({"study",
                   "title",
                   Kind::text,
                   "",
                   "",
                   0,
                   0,
                   {},
                   "one line for figures; the name where empty",
                   {}});
  table.push_back(count("study", "seed", "1", 0, kMostSeed, "of all random numbers; any will do"));
  table.push_back({"study",
                   "runs",
                   Kind::count,
                   "",
                   std::nullopt,
                   1,
                   1e7,
                   {},
                   "repetitions of every cell",
                   "100"});
}

void add_drive(std::vector<Setting>& table) {
  const char* s = "scenario";
  table.push_back(choice(s, "kind", {"simulated"}, "where drives come from"));
  table.push_back({s,
                   "world",
                   Kind::text,
                   "",
                   std::nullopt,
                   0,
                   0,
                   {},
                   "a shipped world, or a path to .csv or .mat with lm and wp",
                   "web_loop"});
  table.push_back(count(s, "loops", "1", 1, 10'000, "times round the way-points"));
  table.push_back(
      choice(s, "noise", {"measured-control", "matched"},
             "noise on the controls the filter is given, or on the truth's motion (SPEC 1.3)"));
  table.push_back(number(s, "wheelbase", "m", "4", 1e-3, 1000, "between the axles"));
  table.push_back(number(s, "speed", "m/s", "3", 1e-3, 1000, "of the front axle"));
  table.push_back(number(s, "control_rate", "Hz", "40", 1e-3, 1e5, "control steps a second"));
  table.push_back(
      number(s, "scan_rate", "Hz", "5", 1e-4, 1e5, "scans a second; must divide control_rate"));
  table.push_back(
      number(s, "waypoint_radius", "m", "1", 1e-3, 1e4, "nearer than this a way-point is reached"));
  table.push_back(number(s, "steer_limit_deg", "deg", "30", 0.1, 89, "largest steering angle"));
  table.push_back(
      number(s, "steer_rate_limit_deg", "deg/s", "20", 0.1, 1e5, "fastest turn of the steering"));
  table.push_back(number(s, "start_x", "m", "0", -1e6, 1e6, "pose before the first step"));
  table.push_back(number(s, "start_y", "m", "0", -1e6, 1e6, "pose before the first step"));
  table.push_back(
      number(s, "start_heading_deg", "deg", "0", -360, 360, "pose before the first step"));
}

void add_noise(std::vector<Setting>& table) {
  const char* s = "scenario";
  table.push_back(number(s, "sigma_speed", "m/s", "0.3", 0, 1000, "noise of the speed"));
  table.push_back(number(s, "sigma_steer_deg", "deg", "3", 0, 180, "noise of the steering angle"));
  table.push_back(number(s, "sigma_range", "m", "0.1", 0, 1000, "noise of a range"));
  table.push_back(number(s, "sigma_bearing_deg", "deg", "1", 0, 180, "noise of a bearing"));
  table.push_back(number(s, "max_range", "m", "30", 1e-3, 1e6, "of the sensor"));
  table.push_back(
      number(s, "field_of_view_deg", "deg", "180", 0.1, 360, "of the sensor, centred ahead"));
  table.push_back(number(s, "clutter_rate", "1", "0", 0, 100, "mean false alarms a scan"));
  table.push_back(
      number(s, "miss_probability", "1", "0", 0, 1, "that a landmark in view is not detected"));
}

/// Fallback "scenario": the scenario's value of the same key.
void add_belief(std::vector<Setting>& table) {
  const char* s = "belief";
  table.push_back(
      number(s, "wheelbase", "m", "scenario", 1e-3, 1000, "what the filter takes it to be"));
  table.push_back(
      number(s, "sigma_speed", "m/s", "scenario", 0, 1000, "what the filter takes it to be"));
  table.push_back(
      number(s, "sigma_steer_deg", "deg", "scenario", 0, 180, "what the filter takes it to be"));
  table.push_back(
      number(s, "sigma_range", "m", "scenario", kTiny, 1000, "what the filter takes it to be"));
  table.push_back(number(s, "sigma_bearing_deg", "deg", "scenario", kTiny, 180,
                         "what the filter takes it to be"));
}

/// The fallback gates are chi-square 5.991 (95 %) and 25 with two degrees of freedom.
void add_association(std::vector<Setting>& table) {
  const char* s = "association";
  table.push_back(
      choice(s, "kind", {"known", "nearest"}, "who says which landmark a detection is (SPEC 17)"));
  table.push_back(number(s, "gate_sigma", "sigma", "1.959963984540054", 0.01, 30,
                         "nearer: may be that landmark"));
  table.push_back(number(s, "new_gate_sigma", "sigma", "4.626072265579014", 0.01, 30,
                         "farther from all: a new one"));
  table.push_back(
      number(s, "log_new_density_offset", "1", "0", -1000, 1000, "added to log p0 of SPEC 17"));
  table.push_back(
      count(s, "most_landmarks", "1000", 1, 100'000, "a larger map has run away: the run fails"));
}

void add_record(std::vector<Setting>& table) {
  table.push_back({"record",
                   "columns",
                   Kind::choices,
                   "",
                   "pose, covariance, ancestry",
                   0,
                   0,
                   {"pose", "covariance", "ancestry", "particles", "association", "map"},
                   "what is stored",
                   {}});
  table.push_back(choice("record", "rate", {"control", "scan"},
                         "store poses at every control step or at scans only"));
  table.push_back(count("record", "map_rows", "0", 0, 100'000,
                        "rows of map columns with unknown association; 0: as many as the world"));
}

std::vector<Setting> make_table() {
  std::vector<Setting> table;
  add_study(table);
  add_drive(table);
  add_noise(table);
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

Setting setting_of(const FilterOption& option) {
  const Kind kind = option.kind == FilterOption::Kind::number    ? Kind::number
                    : option.kind == FilterOption::Kind::integer ? Kind::count
                                                                 : Kind::choice;
  return {"",          option.name,    kind,           "", option.fallback, option.least,
          option.most, option.choices, option.meaning, {}};
}

}  // namespace montecarta
