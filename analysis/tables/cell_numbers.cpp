// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/finite_mean.hpp"
#include "analysis/tables/cell_series.hpp"
#include "analysis/tables/number_text.hpp"

#include <limits>

namespace montecarta {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

using Numbers = std::vector<NamedNumber>;

/// Mean, spread, standard error and interval of a score.
void add(const std::string& name, const std::string& units, const Summary& summary,
         const CellAnalysis& cell, double RunScores::*score, Numbers& all) {
  all.push_back({name + "_mean", units, summary.mean});
  all.push_back({name + "_sd", units, summary.sd});
  all.push_back({name + "_standard_error", units, summary.standard_error()});
  all.push_back({name + "_lower", units, cell.lower.*score});
  all.push_back({name + "_upper", units, cell.upper.*score});
}

void add_errors(const CellAnalysis& cell, Numbers& all) {
  const ErrorSummary& error = cell.error;
  add("position_rmse", "m", error.position_rmse, cell, &RunScores::position_rmse, all);
  add("position_mse", "m2", error.position_mse, cell, &RunScores::position_mse, all);
  add("position_error", "m", error.position_mean, cell, &RunScores::position_mean, all);
  add("position_error_variance_over_time", "m2", error.position_variance, cell,
      &RunScores::position_variance, all);
  add("heading_rmse", "rad", error.heading_rmse, cell, &RunScores::heading_rmse, all);
  add("heading_mse", "rad2", error.heading_mse, cell, &RunScores::heading_mse, all);
  add("heading_error", "rad", error.heading_mean, cell, &RunScores::heading_mean, all);
}

void add_particles(const CellAnalysis& cell, Numbers& all) {
  const WeightSummary weights = cell.weights.value_or(WeightSummary{});
  const DiversitySummary diversity = cell.diversity.value_or(DiversitySummary{});
  add("ess", "1", weights.ess, cell, &RunScores::ess, all);
  add("resampling_rate", "1", weights.resampling_rate, cell, &RunScores::resampling_rate, all);
  add("ancestors_last_resampling", "1", diversity.last_resampling, cell,
      &RunScores::last_resampling, all);
  add("ancestors_10_s_ago", "1", diversity.lag, cell, &RunScores::lag, all);
  add("ancestors_at_start", "1", diversity.root, cell, &RunScores::root, all);
  add("ancestors_at_start_at_the_end", "1", diversity.final_root, cell, &RunScores::final_root,
      all);
}

void add_lineages(const CellAnalysis& cell, Numbers& all) {
  const bool known = cell.lineages.has_value();
  const LineageSummary lineages = cell.lineages.value_or(LineageSummary{});
  for (std::size_t lag = 0; lag < kLineageLags.size(); ++lag) {
    all.push_back({"distinct_ancestors_" + readable(kLineageLags[lag], 1) + "_s_ago", "1",
                   known ? lineages.ancestors[lag] : kNaN});
  }
  all.push_back({"coalescence", "s", known ? lineages.coalescence : kNaN});
  all.push_back({"coalesced_share", "1", known ? lineages.coalesced_share : kNaN});
  all.push_back({"monte_carlo_share", "1", known ? lineages.monte_carlo_share : kNaN});
}

void add_association(const CellAnalysis& cell, Numbers& all) {
  const AssociationSummary sums = cell.association.value_or(AssociationSummary{});
  add("association_correct", "1", sums.correct, cell, &RunScores::correct, all);
  add("association_wrong", "1", sums.wrong, cell, &RunScores::wrong, all);
  add("association_new_again", "1", sums.new_again, cell, &RunScores::new_again, all);
  add("association_missed", "1", sums.missed, cell, &RunScores::missed, all);
  add("association_clutter", "1", sums.clutter, cell, &RunScores::clutter, all);
}

void add_maps(const CellAnalysis& cell, Numbers& all) {
  const MapErrors& map = cell.map;
  all.push_back({"position_efficiency", "1", cell.efficiency.position});
  all.push_back({"heading_efficiency", "1", cell.efficiency.heading});
  all.push_back({"map_efficiency", "1", cell.efficiency.map});
  add("landmark_rms", "m", map.rms, cell, &RunScores::landmark_rms, all);
  add("landmark_nees", "1", map.nees, cell, &RunScores::landmark_nees, all);
  add("gospa", "m", map.gospa, cell, &RunScores::gospa, all);
  add("gospa_localisation", "m", map.localisation, cell, &RunScores::gospa_localisation, all);
  add("landmarks_missed", "1", map.missed, cell, &RunScores::landmarks_missed, all);
  add("landmarks_invented", "1", map.invented, cell, &RunScores::landmarks_invented, all);
  all.push_back({"landmarks_undefined", "1", static_cast<double>(map.undefined)});
}

/// At the last stored scan.
void add_joint(const CellAnalysis& cell, Numbers& all) {
  const JointConsistency& joint = cell.joint;
  const bool known = joint.verdict != Verdict::untested;
  const Interval bounds = known ? joint.bounds.back() : Interval{kNaN, kNaN};
  all.push_back({"joint_components", "1", known ? joint.dimension.back() : kNaN});
  all.push_back({"joint_nees_per_component", "1", known ? joint.average.back() : kNaN});
  all.push_back({"joint_nees_lower", "1", bounds.lower});
  all.push_back({"joint_nees_upper", "1", bounds.upper});
  all.push_back({"joint_undefined", "1", static_cast<double>(joint.undefined)});
}

void add_anatomy(const CellAnalysis& cell, Numbers& all) {
  const bool known = cell.anatomy.has_value();
  const ErrorAnatomy anatomy = cell.anatomy.value_or(ErrorAnatomy{});
  const Credibility credibility = cell.credibility.value_or(Credibility{kNaN, kNaN});
  all.push_back({"worst_variance_ratio", "1", known ? anatomy.mean_worst_ratio : kNaN});
  for (std::size_t c = 0; c < kErrorComponents.size(); ++c) {
    all.push_back({std::string("worst_direction_") + kErrorComponents[c], "1",
                   known ? anatomy.worst_direction[c] : kNaN});
  }
  all.push_back({"bias_share", "1", known ? anatomy.mean_bias_share : kNaN});
  all.push_back({"noncredibility", "dB", credibility.noncredibility});
  all.push_back({"inclination", "dB", credibility.inclination});
}

void add_survival(const CellAnalysis& cell, Numbers& all) {
  const bool known = cell.survival && cell.survival->runs > 0;
  const Survival survival = cell.survival.value_or(Survival{});
  all.push_back({"runs_lost", "1", known ? static_cast<double>(survival.lost) : kNaN});
  all.push_back({"half_lost", "s", known ? survival.median : kNaN});
  all.push_back({"half_lost_lower", "s", known ? survival.median_interval.lower : kNaN});
  all.push_back({"half_lost_upper", "s", known ? survival.median_interval.upper : kNaN});
}

void add_innovations(const CellAnalysis& cell, Numbers& all) {
  const bool known = cell.innovations.has_value();
  const Innovations found = cell.innovations.value_or(Innovations{});
  all.push_back({"nis_per_component", "1", known ? found.mean : kNaN});
  all.push_back({"nis_per_component_lower", "1", known ? found.interval.lower : kNaN});
  all.push_back({"nis_per_component_upper", "1", known ? found.interval.upper : kNaN});
  all.push_back({"nis_share_inside", "1", known ? found.share_inside : kNaN});
  for (std::size_t lag = 1; lag <= kInnovationLags; ++lag) {
    all.push_back({"innovation_correlation_" + std::to_string(lag), "1",
                   known ? found.autocorrelation[lag - 1] : kNaN});
  }
  all.push_back({"innovation_correlation_bound", "1", known ? found.bound : kNaN});
}

}  // namespace

std::vector<NamedNumber> numbers_of(const CellAnalysis& cell) {
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  Numbers all = {{"runs_failed", "1", count(cell.failures.size())},
                 {"runs_complete", "1", count(cell.complete)},
                 {"runs_missing", "1", count(cell.missing)},
                 {"runs_spared", "1", count(cell.spared)},
                 {"particles", "1", count(cell.particles)}};
  add_errors(cell, all);
  add_particles(cell, all);
  add_lineages(cell, all);
  add_association(cell, all);
  add_maps(cell, all);
  add_joint(cell, all);
  add_anatomy(cell, all);
  add_survival(cell, all);
  add_innovations(cell, all);
  add("numerical_faults", "1", cell.numerical_faults, cell, &RunScores::numerical_faults, all);
  add("cpu_seconds", "s", cell.cpu_seconds, cell, &RunScores::cpu_seconds, all);
  return all;
}

std::vector<NamedNumber> numbers_of(const CellAnalysis& cell, const NeesResult& nees,
                                    double level) {
  const Consistency& found = nees.consistency;
  const std::size_t dimension = nees.series.dimension;
  const Interval band = nees_bounds(cell.complete, dimension, level);
  const Interval exits = found.exit_interval.value_or(Interval{kNaN, kNaN});
  return {{"level", "1", level},
          {"dimension", "1", static_cast<double>(dimension)},
          {"anees_mean", "1", found.mean},
          {"anees_mean_lower", "1", found.average_interval.lower},
          {"anees_mean_upper", "1", found.average_interval.upper},
          {"right_anees_lower", "1", found.average_bounds.lower},
          {"right_anees_upper", "1", found.average_bounds.upper},
          {"nees_median", "1", found.median},
          {"right_median", "1", right_median(dimension)},
          {"nees_trimmed", "1", found.trimmed},
          {"right_trimmed", "1", right_trimmed(dimension)},
          {"lower", "1", band.lower},
          {"upper", "1", band.upper},
          {"share_inside", "1", found.share_inside},
          {"share_above", "1", found.share_above},
          {"share_below", "1", found.share_below},
          {"above_whole_run_band_s", "s", found.above_from.value_or(kNever)},
          {"below_whole_run_band_s", "s", found.below_from.value_or(kNever)},
          {"lasting_exit_s", "s", found.lasting_exit.value_or(kNever)},
          {"lasting_exit_lower_s", "s", exits.lower},
          {"lasting_exit_upper_s", "s", exits.upper},
          {"samples", "1", static_cast<double>(nees.series.samples)},
          {"floored", "1", static_cast<double>(nees.series.floored)},
          {"undefined", "1", static_cast<double>(nees.series.undefined)}};
}

}  // namespace montecarta
