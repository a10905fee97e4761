// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/make_plan.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/random/stream.hpp"
#include "engine/records/columns.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/study/enough_runs.hpp"
#include "experiments/study/fixes.hpp"
#include "experiments/study/known_map.hpp"
#include "experiments/study/make_drives.hpp"
#include "experiments/study/vehicle_and_sensor.hpp"
#include "experiments/text/words.hpp"
#include "filters/factory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::experiments {
namespace {

/// The belief of a cell: that of the study, with noise scaled by the factors of the cell.
Belief belief_of(const Settings& s, const CellSpec& spec) {
  const char* in = "belief";
  const double motion = mismatch_of(spec, "motion_noise");
  const double sensor = mismatch_of(spec, "sensor_noise");
  ControlNoise control = control_noise_of(s, in);
  for (double& sigma : control.sigma) sigma *= motion;
  for (double& alpha : control.alpha) alpha *= motion * motion;
  for (double& sigma : control.increment.sigma) sigma *= motion;
  for (double& alpha : control.increment.alpha) alpha *= motion * motion;
  Belief belief{.vehicle = vehicle_of(s, in), .control = control};
  take_sensor(s, in, sensor, belief);
  if (const auto sigma = believed_sigma_fix(s)) belief.sigma_fix = sensor * *sigma;
  return belief;
}

/// The chi-square gate with 1 or 2 degrees of freedom that accepts with the probability of k sigma
/// of a normal: the quantile at p = erf(k / sqrt 2), which is k^2 or -2 ln(1 - p).
double gate_of(double sigmas, std::size_t dimension) {
  if (dimension == 1) return sigmas * sigmas;
  return -2.0 * std::log(engine::normal_tails(sigmas));
}

AssociationSettings association_of(const Settings& s) {
  const char* in = "association";
  AssociationSettings association;
  association.kind = s.text(in, "kind") == "nearest" ? Association::nearest : Association::known;
  const std::size_t dimension = components_of(sensor_of(s, "belief")).size();
  association.gate = gate_of(s.number(in, "gate_sigma"), dimension);
  association.new_gate = gate_of(s.number(in, "new_gate_sigma"), dimension);
  association.log_new_density_offset = s.number(in, "log_new_density_offset");
  association.most_landmarks = s.count(in, "most_landmarks");
  if (association.new_gate < association.gate) {
    throw StudyError(s.place(in, "new_gate_sigma") +
                     ": new_gate_sigma is below gate_sigma (a detection would be old "
                     "and new at once): enlarge new_gate_sigma");
  }
  if (map_is_known(s)) {  // a known map is complete
    association.new_gate = std::numeric_limits<double>::infinity();
    association.most_landmarks = std::numeric_limits<std::size_t>::max();
  }
  return association;
}

ColumnSelection columns_of(const Settings& s) {
  ColumnSelection columns{.joint_scans = s.count("record", "joint_scans"),
                          .scans_only = s.text("record", "rate") == "scan",
                          .full_runs = s.count("record", "full_runs")};
  for (const ColumnGroup& group : column_groups()) {
    if (group.is_chosen != nullptr)
      columns.*(group.is_chosen) = s.lists("record", "columns", group.name);
  }
  if (columns.sums) {  // rows are not kept, so these columns cost nothing
    columns.covariance = columns.ancestry = true;
    columns.full_runs = std::max<std::uint64_t>(columns.full_runs, 1);
  }
  return columns;
}

/// Number of rows of the map columns. A map that is known exactly is no estimate and has none. With
/// unknown association, landmarks are numbered in the order of initialisation and may outnumber
/// those of the world, and for a recorded drive the number of those is unknown.
std::size_t map_rows_of(const FilterSetup& setup, const Settings& s) {
  if (map_is_exact(s)) return 0;
  const std::uint64_t asked = s.count("record", "map_rows");
  if (setup.association.kind == Association::known || setup.map_is_known) return setup.landmarks;
  if (asked > 0) return asked;
  return s.scenario_kind() == "simulated" ? setup.landmarks : setup.association.most_landmarks;
}

std::size_t particles_of(const CellSpec& spec) {
  if (!spec.filter->reports.particles) return 0;
  const auto named = [](const auto& option) { return option.first == "particles"; };
  return to_count(std::ranges::find_if(spec.options, named)->second).value();
}

/// A function that makes the cell's filter. An external program that is allowed is made once here,
/// which does not start it but checks that it exists.
std::function<std::unique_ptr<SlamFilter>()> maker_of(const CellSpec& spec,
                                                      const FilterSetup& setup,
                                                      ExternalPrograms programs) {
  const auto make = [make = spec.filter->make, setup] { return make(setup); };
  if (!starts_program(*spec.filter)) return make;
  if (programs == ExternalPrograms::refused) {
    return [label = spec.label]() -> std::unique_ptr<SlamFilter> {
      throw StudyError("cell {} is an external program that may not be started", label);
    };
  }
  at_place(spec.place, make);
  return make;
}

FilterSetup setup_of(const CellSpec& spec, const Study& study) {
  std::map<std::string, std::string, std::less<>> values(spec.options.begin(), spec.options.end());
  const bool is_known = map_is_known(study.settings);
  return {.belief = belief_of(study.settings, spec),
          .association = association_of(study.settings),
          .options = FilterOptions(std::move(values)),
          .landmarks = std::max(identities_of(study), is_known ? landmarks_of(study).size() : 0),
          .map_is_known = is_known};
}

/// The capabilities that the filter has in this study.
Capabilities capabilities_of(const CellSpec& spec, const Study& study) {
  const FilterKind& filter = *spec.filter;
  Capabilities reports = filter.reports;
  if (filter.restrict_reports) filter.restrict_reports(setup_of(spec, study), reports);
  if (map_is_exact(study.settings)) reports.joint = false;
  return reports;
}

/// Returns whether a filter uses no random numbers: those of this program without particles. Nobody
/// knows it of programs and of filters from another source tree.
bool is_deterministic(const FilterKind& filter) {
  const auto added = filters::added_filter_kinds();
  return !filter.reports.particles && filter.name != "external" &&
         std::ranges::count(added, filter.name, &FilterKind::name) == 0;
}

Cell cell_of(const CellSpec& spec, const Study& study, ExternalPrograms programs) {
  const FilterSetup setup = setup_of(spec, study);
  const FilterKind& filter = *spec.filter;
  return {.label = spec.label,
          .filter = filter.name,
          .long_name = filter.long_name + (spec.distinction.empty() ? "" : ", " + spec.distinction),
          .particles = particles_of(spec),
          .reports = capabilities_of(spec, study),
          .landmarks = map_rows_of(setup, study.settings),
          .is_deterministic = is_deterministic(filter),
          .settings = spec.options,
          .make_filter = maker_of(spec, setup, programs)};
}

/// The settings of the scenario, then those of other sections with the name of the section in
/// front.
std::vector<std::pair<std::string, std::string>> scenario_facts(const Settings& settings) {
  auto facts = stated_settings(settings, "scenario");
  for (const char* section : {"belief", "association"}) {
    for (const auto& [key, value] : stated_settings(settings, section))
      facts.emplace_back(formatted("{}.{}", section, key), value);
  }
  return facts;
}

/// What the odometry of recorded drives says of their time and way: "1549 s and 3901 m". Long gaps
/// are added, since the motion in them is unknown.
std::string odometry_in_words(const Settings& settings, const DriveSource& drives) {
  const Vehicle vehicle = vehicle_of(settings, "belief");
  const std::uint64_t number = std::max<std::uint64_t>(drives.own_drives(), 1);
  constexpr double kLongGap = 5.0;  // [s]
  double seconds = 0.0, metres = 0.0, gap = 0.0;
  Drive drive;
  for (std::uint64_t run = 0; run < number; ++run) {
    const Itinerary& itinerary = drives.itinerary_of(run);
    drives.generate(run, drive);
    gap = std::max(gap, itinerary.longest_hold);
    for (std::size_t k = 0; k < drive.controls.size(); ++k) {
      const BodyStep<double> step =
          models::body_step(vehicle, drive.controls[k], itinerary.duration(k));
      metres += length(step.forward, step.left);
    }
    seconds += drive.controls.empty() ? 0.0 : itinerary.step_time[drive.controls.size() - 1];
  }
  return formatted("{} s and {} m{}", std::llround(seconds), std::llround(metres),
                   number == 1 ? "" : formatted(" in {} drives", number)) +
         (gap > kLongGap ? formatted(", with gaps of up to {} s", std::llround(gap)) : "");
}

/// Throws StudyError if a column is to be stored to which there is an objection.
void refuse_column(const Study& study, const std::string& column, const std::string& objection) {
  if (objection.empty()) return;
  throw StudyError("{}: {} {}", study.settings.place("record", "columns"), column, objection);
}

/// Throws StudyError if cells stop by their verdict but cannot have one.
void require_verdict(const Study& study) {
  if (!study.until || study.until->metric) return;
  const Settings& settings = study.settings;
  const std::string problem =
      formatted("{}: until = {}", settings.place("study", "until"), text_of(*study.until));
  if (settings.scenario_kind() != "simulated") {
    throw StudyError(problem +
                     " and a recorded drive (its true path is unknown, so that no verdict ever "
                     "comes): remove it");
  }
  if (!settings.lists("record", "columns", "covariance")) {
    throw StudyError(problem +
                     " without covariance in record.columns (no NEES, so that no verdict ever "
                     "comes): add covariance there");
  }
}

/// Throws StudyError if no scan is judged, or if the drives of runs have times of their own.
void refuse_judging_from(const Study& study, const Itinerary& itinerary) {
  const double from = study.settings.number("study", "judge_from");
  if (from == 0.0) return;
  const std::string problem =
      formatted("{}: judge_from = {} ", study.settings.place("study", "judge_from"),
                study.settings.text("study", "judge_from"));
  if (!study.logs.empty()) {
    throw StudyError(problem +
                     "and a recorded drive (it is judged at the fixes of its references): take "
                     "judge_from out");
  }
  if (first_judged_scan(study, itinerary) < itinerary.scans()) return;
  const double last = itinerary.step_time.at(itinerary.scan_step.back());
  throw StudyError(
      "{}(s; the last scan is at {} s, so that nothing would be judged): give an earlier time",
      problem, to_text(last));
}

/// Refuses to run a part of the runs if the stopping rule needs all first runs of a cell.
void refuse_part(const Study& study) {
  if (!study.until->metric) return;
  throw StudyError(
      "{}: until = {} and only part of the runs (a part cannot decide when all runs are enough): "
      "run the whole study in one piece, or add --set study.until= to make all runs",
      study.settings.place("study", "until"), text_of(*study.until));
}

}  // namespace

RunRange parse_run_range(const std::string& text, std::uint64_t runs) {
  const auto parts = split(text, ':');
  const auto first = parts.front().empty() ? 0 : to_count(parts.front());
  const auto last = parts.back().empty() ? runs : to_count(parts.back());
  if (parts.size() == 2 && first && last && *first < *last && *last <= runs) return {*first, *last};
  throw StudyError(
      "--runs {}: no range of this study's runs (A:B means A, ..., B-1 out of 0 to {}): give e.g. "
      "--runs 0:{}",
      text, runs - 1, runs);
}

RunRange parse_shard(const std::string& text, std::uint64_t runs, std::uint64_t runs_of_unit) {
  const auto parts = split(text, '/');
  const auto index = to_count(parts.front());
  const auto count = to_count(parts.back());
  const std::uint64_t units = (runs + runs_of_unit - 1) / runs_of_unit;
  if (parts.size() == 2 && index && count && *index < *count && *count <= units) {
    return {*index * units / *count * runs_of_unit,
            std::min((*index + 1) * units / *count * runs_of_unit, runs)};
  }
  throw StudyError(
      "--shard {}: no shard of this study (I/N means part I, from 0 to N-1, of N; at most {} "
      "parts, one {}): give e.g. --shard 0/{}",
      text, units, runs_of_unit == 1 ? "a run" : formatted("for {} runs", runs_of_unit),
      units < 4 ? units : 4);
}

std::string objection_to_joint(const Study& study) {
  const auto has_joint = [](const CellSpec& cell) { return cell.filter->reports.joint; };
  if (map_is_exact(study.settings)) {
    return "(a map that is known exactly has no covariance): take joint out, or give map_sigma_m";
  }
  if (std::ranges::none_of(study.cells, has_joint)) {
    std::vector<std::string> names;
    for (const FilterKind& kind : filter_kinds()) {
      if (kind.reports.joint && !kind.name.starts_with("plain_")) names.push_back(kind.name);
    }
    return "(none of the cells' filters has a joint covariance): take joint out, or add a cell of "
           "one of " +
           joined(names);
  }
  const Settings& settings = study.settings;
  if (settings.text("association", "kind") == "known" && settings.scenario_kind() == "simulated")
    return {};
  return "(the landmarks of a map cannot be identified, and covariances of whole maps are "
         "large): take joint out, or set association.kind = known in a simulation";
}

namespace {

/// Returns whether a filter of the study declares columns of this group.
bool has_own_columns(const Study& study, std::string_view group) {
  return std::ranges::any_of(study.cells, [&](const CellSpec& cell) {
    const Capabilities reports = capabilities_of(cell, study);
    return std::ranges::count(reports.own_columns, group, &OwnColumn::group) > 0;
  });
}

}  // namespace

std::string objection_to_observability(const Study& study) {
  if (has_own_columns(study, "observability")) return {};
  return "(no cell reports the information of its detections about the common heading): take "
         "observability out, or add a cell of ekf_slam or riekf_slam with a sensor of which one "
         "detection fixes a landmark";
}

std::string objection_to_evolution(const Study& study) {
  if (has_own_columns(study, "evolution")) return {};
  return "(no cell's filter evolves anything): take evolution out, or add a cell of de_srcd or "
         "ampf_de";
}

namespace {

/// Throws StudyError if the study stores sums of runs and cannot, or not of this range.
void require_summable(const Study& study, const std::optional<RunRange>& range) {
  const Settings& settings = study.settings;
  if (!settings.lists("record", "columns", "sums")) return;
  const std::string place = settings.place("record", "columns") + ": sums ";
  const std::string group = std::to_string(kRunsOfAGroup);
  if (study.until) {
    throw StudyError(place +
                     "with study.until (interim analyses need the rows of all runs): take "
                     "one of them out");
  }
  if (!study.logs.empty()) {
    throw StudyError(place + "of a recorded drive (its runs are judged one by one): take sums out");
  }
  if (settings.count("record", "full_runs") > kRunsOfAGroup) {
    throw StudyError("{}: more than {} (sums store at most so many runs in full): lower it",
                     settings.place("record", "full_runs"), group);
  }
  const std::uint64_t runs = settings.count("study", "runs");
  const auto is_border = [&](std::uint64_t run) { return run % kRunsOfAGroup == 0 || run == runs; };
  if (range && !(is_border(range->first) && is_border(range->last))) {
    throw StudyError(
        "--runs {}:{}: not whole groups (runs are summed up in groups of {}): give multiples of {}",
        range->first, range->last, group, group);
  }
}

}  // namespace

std::size_t first_judged_scan(const Study& study, const Itinerary& itinerary) {
  const double from = study.settings.number("study", "judge_from");
  const auto time_of = [&](std::uint32_t step) { return itinerary.step_time[step]; };
  const auto first = std::ranges::lower_bound(itinerary.scan_step, from, {}, time_of);
  return static_cast<std::size_t>(first - itinerary.scan_step.begin());
}

StudyPlan make_plan(const Study& study, std::optional<RunRange> range, ExternalPrograms programs) {
  const Settings& settings = study.settings;
  StudyPlan plan;
  if (study.until) plan.is_enough = enough_runs(*study.until, settings.place("study", "until"));
  if (range && study.until) refuse_part(study);
  require_summable(study, range);
  require_verdict(study);
  plan.name = settings.text("study", "name");
  plan.title = settings.text("study", "title");
  plan.seed = settings.count("study", "seed");
  plan.runs = settings.count("study", "runs");
  plan.first_run = range ? range->first : 0;
  plan.last_run = range ? range->last : plan.runs;
  for (const CellSpec& spec : study.cells) plan.cells.push_back(cell_of(spec, study, programs));
  plan.columns = columns_of(settings);
  if (plan.columns.joint) refuse_column(study, "joint", objection_to_joint(study));
  if (plan.columns.observability)
    refuse_column(study, "observability", objection_to_observability(study));
  if (plan.columns.evolution) refuse_column(study, "evolution", objection_to_evolution(study));
  plan.drives = drives_of(study, plan.seed);
  refuse_judging_from(study, plan.drives->itinerary());
  plan.own_landmarks = own_landmarks_of(study, plan.seed);
  plan.scenario = scenario_facts(settings);
  if (settings.scenario_kind() != "simulated")
    plan.scenario.emplace_back(kOdometryFact, odometry_in_words(settings, *plan.drives));
  plan.resolved_text = resolved_text(study);
  return plan;
}

}  // namespace montecarta::experiments
