// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/study_settings.hpp"
#include "engine/records/column_table.hpp"
#include "experiments/study/setting_builders.hpp"

namespace montecarta::experiments {
namespace {

using namespace setting_builders;

void add_study(std::vector<Setting>& table) {
  const char* s = "study";
  table.push_back(required(text(s, "name", "what the study is called"), "my_study"));
  table.push_back(text(s, "title", "one line for figures; the name where empty"));
  table.push_back(count(s, "seed", "1", 0, kMostSeed, "of all random numbers; any will do"));
  table.push_back(required(count(s, "runs", "", 1, 1e7, "repetitions of every cell"), "100"));
  table.push_back(
      text(s, "until",
           "METRIC < HALF-WIDTH or verdict: a cell stops when so precise or judged; else empty"));
  table.push_back(number(s, "within", "1", kUsualWithin, kLeastMargin, kMostMargin,
                         "consistent: ANEES so many times too large or small at most"));
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
