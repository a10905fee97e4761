// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/means.hpp"
#include "analysis/tables/cell_series.hpp"

#include <initializer_list>
#include <limits>
#include <string_view>

namespace montecarta {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

using Numbers = std::vector<NamedNumber>;

/// Mean, spread, standard error and interval of scores.
void add_scores(const CellAnalysis& cell, std::initializer_list<std::string_view> names,
                Numbers& all) {
  for (const std::string_view name : names) {
    const Score& score = *find_score(name);
    const Summary summary = cell.over_runs(name);
    const Interval interval = cell.interval_of(name);
    const std::string prefix = std::string(name) + "_";
    all.push_back({prefix + "mean", score.units, summary.mean});
    all.push_back({prefix + "sd", score.units, summary.sd});
    all.push_back({prefix + "standard_error", score.units, summary.standard_error()});
    all.push_back({prefix + "lower", score.units, interval.lower});
    all.push_back({prefix + "upper", score.units, interval.upper});
  }
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

void add_efficiency(const CellAnalysis& cell, Numbers& all) {
  all.push_back({"position_efficiency", "1", cell.efficiency.position});
  all.push_back({"heading_efficiency", "1", cell.efficiency.heading});
  all.push_back({"map_efficiency", "1", cell.efficiency.map});
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
  add_scores(cell,
             {"position_rmse", "position_mse", "position_error",
              "position_error_variance_over_time", "heading_rmse", "heading_mse", "heading_error",
              "ess", "resampling_rate", "ancestors_last_resampling", "ancestors_10_s_ago",
              "ancestors_at_start", "ancestors_at_start_at_the_end"},
             all);
  add_lineages(cell, all);
  add_scores(cell,
             {"association_correct", "association_wrong", "association_new_again",
              "association_missed", "association_clutter"},
             all);
  add_efficiency(cell, all);
  add_scores(cell,
             {"landmark_rms", "landmark_nees", "gospa", "gospa_localisation", "landmarks_missed",
              "landmarks_invented"},
             all);
  all.push_back({"landmarks_undefined", "1", count(cell.map.undefined)});
  add_joint(cell, all);
  add_anatomy(cell, all);
  add_survival(cell, all);
  add_innovations(cell, all);
  add_scores(cell, {"numerical_faults", "cpu_seconds"}, all);
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
