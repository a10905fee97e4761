// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/verdict_table.hpp"

#include "analysis/metrics/cramer_rao.hpp"
#include "analysis/metrics/nees.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/means.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/survival.hpp"
#include "engine/numbers/angle.hpp"

#include <algorithm>
#include <limits>

namespace montecarta::analysis {
namespace {

constexpr double kDegrees = 180.0 / kPi;

/// The band of all complete runs: single scans may have fewer valid ones.
std::string band_text(const CellAnalysis& cell, std::size_t dimension, double level) {
  if (cell.complete == 0) return "-";
  return interval_text(nees_bounds(cell.complete, dimension, level));
}

/// From when to the end the average is outside the band for all scans.
std::string outside_text(const Consistency& found) {
  if (found.stays_above_from) return fixed_seconds(*found.stays_above_from) + ", above";
  if (found.stays_below_from) return fixed_seconds(*found.stays_below_from) + ", below";
  return "never";
}

/// The average divided by the expected one, with its interval.
std::string ratio_text(const NeesResult& nees, double level) {
  const Consistency& found = nees.consistency;
  const auto d = static_cast<double>(nees.series.dimension);
  if (!found.is_overdispersed) return with_interval(found.mean / d, found.ratio);
  return text_of_mean(nees.series.run_averages, found.mean,
                      {d * found.ratio.lower, d * found.ratio.upper}, 1.0 / d, level);
}

std::string median_exit_text(const CellAnalysis& cell) {
  const Survival& survival = cell.get<Survival>();
  if (survival.runs == 0) return "-";
  return time_with_interval(survival.median, survival.median_interval);
}

std::string score_text(const CellAnalysis& cell, std::string_view score, double level,
                       double factor = 1.0) {
  return text_of_mean(cell.scores.column(score), cell.over_runs(score).mean,
                      cell.interval_of(score), factor, level);
}

std::vector<std::string> verdict_row(const CellAnalysis& cell, double level) {
  const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
  const Consistency found = cell.consistency();
  std::vector<std::string> row = {cell.label, runs_in_words(cell), in_words(found),
                                  cell.leading == Moments::corrected ? "particles" : "Gaussian"};
  if (found.verdict == Verdict::untested) {
    row.insert(row.end(), 5, "-");
  } else {
    row.insert(row.end(),
               {compact(found.mean), ratio_text(*pose, level), readable(found.least_ratios.upper),
                percent(found.share_inside), outside_text(found)});
  }
  row.push_back(median_exit_text(cell));
  return row;
}

std::vector<std::string> accuracy_row(const CellAnalysis& cell, double level) {
  return {cell.label,
          score_text(cell, "position_rmse", level),
          score_text(cell, "heading_rmse", level, kDegrees),
          percent(cell.get<Efficiency>().position),
          readable(cell.over_runs("ess").mean),
          readable(cell.over_runs("ancestors_at_start_at_the_end").mean),
          readable(cell.over_runs("cpu_seconds").mean)};
}

/// The average of an ideal filter with these moments.
double ideal_nees(const CellAnalysis& cell, const NeesResult& nees) {
  const std::size_t d = nees.series.dimension;
  const bool drawn = nees.moments == Moments::spread && cell.particles > 0;
  return drawn ? ideal_spread_nees(d, cell.particles) : static_cast<double>(d);
}

std::vector<std::string> consistency_row(const CellAnalysis& cell, const NeesResult& nees,
                                         double level) {
  const Consistency& found = nees.consistency;
  return {cell.label,
          name_of(nees.block),
          name_of(nees.moments),
          in_words(found),
          compact(found.mean),
          ratio_text(nees, level),
          readable(found.median / expected_median(nees.series.dimension)),
          readable(found.trimmed / expected_trimmed(nees.series.dimension)),
          readable(ideal_nees(cell, nees)),
          band_text(cell, nees.series.dimension, level),
          percent(found.share_inside),
          percent(found.share_above),
          percent(found.share_below),
          std::to_string(nees.series.lower_rank),
          std::to_string(nees.series.unusable),
          std::to_string(nees.series.too_few),
          std::to_string(nees.series.unjudged_runs)};
}

}  // namespace

std::string name_of(ErrorBlock block) {
  return block == ErrorBlock::pose       ? "pose"
         : block == ErrorBlock::position ? "position"
                                         : "heading";
}

std::string name_of(Moments moments) {
  return moments == Moments::mixture     ? "mixture"
         : moments == Moments::corrected ? "corrected"
                                         : "spread";
}

std::vector<NamedNumber> numbers_of(const CellAnalysis& cell, const NeesResult& nees,
                                    double level) {
  const Consistency& found = nees.consistency;
  const std::size_t dimension = nees.series.dimension;
  const Interval band = nees_bounds(cell.complete, dimension, level);
  constexpr double kNever = std::numeric_limits<double>::infinity();
  return {{"level", "1", level},
          {"dimension", "1", static_cast<double>(dimension)},
          {"anees_mean", "1", found.mean},
          {"anees_mean_lower", "1", found.average_interval.lower},
          {"anees_mean_upper", "1", found.average_interval.upper},
          {"expected_anees_lower", "1", found.average_bounds.lower},
          {"expected_anees_upper", "1", found.average_bounds.upper},
          {"within", "1", found.within},
          {"ratio_lower", "1", found.ratio.lower},
          {"ratio_upper", "1", found.ratio.upper},
          {"least_ratio_found_below", "1", found.least_ratios.lower},
          {"least_ratio_found_above", "1", found.least_ratios.upper},
          {"overdispersed", "1", found.is_overdispersed ? 1.0 : 0.0},
          {"more_runs", "1", found.more_runs ? static_cast<double>(*found.more_runs) : kNaN},
          {"nees_median", "1", found.median},
          {"expected_median", "1", expected_median(dimension)},
          {"nees_trimmed", "1", found.trimmed},
          {"expected_trimmed", "1", expected_trimmed(dimension)},
          {"lower", "1", band.lower},
          {"upper", "1", band.upper},
          {"share_inside", "1", found.share_inside},
          {"share_above", "1", found.share_above},
          {"share_below", "1", found.share_below},
          {"above_whole_run_band_s", "s", found.above_from.value_or(kNever)},
          {"below_whole_run_band_s", "s", found.below_from.value_or(kNever)},
          {"stays_above_from_s", "s", found.stays_above_from.value_or(kNever)},
          {"stays_below_from_s", "s", found.stays_below_from.value_or(kNever)},
          {"samples", "1", static_cast<double>(nees.series.samples)},
          {"lower_rank", "1", static_cast<double>(nees.series.lower_rank)},
          {"unusable", "1", static_cast<double>(nees.series.unusable)},
          {"too_few_draws", "1", static_cast<double>(nees.series.too_few)},
          {"unjudged_runs", "1", static_cast<double>(nees.series.unjudged_runs)}};
}

std::string runs_in_words(const CellAnalysis& cell) {
  std::string words;
  if (!cell.failures.empty()) words += std::to_string(cell.failures.size()) + " FAILED, ";
  if (cell.missing > 0) words += std::to_string(cell.missing) + " missing, ";
  words += std::to_string(cell.complete) + " complete";
  if (cell.spared == 0 && cell.looks_planned == 0) return words;
  const std::size_t made = cell.complete + cell.failures.size();
  const std::string look =
      ", look " + std::to_string(cell.looks_made) + " of " + std::to_string(cell.looks_planned);
  if (cell.spared == 0) return words + look;
  return words + ", stopped at " + std::to_string(made) + " of " +
         std::to_string(made + cell.missing + cell.spared) + ": " +
         (cell.looks_planned > 0 ? "verdict known" + look : "precise enough");
}

TextTable verdict_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},
                    {"runs", Align::left},
                    {"verdict", Align::left},
                    {"NEES of", Align::left},
                    {"ANEES"},
                    {"/ expected [" + level_text(study.level) + "]"},
                    {"would find"},
                    {"scans inside"},
                    {"outside to the end from"},
                    {"half the runs lost at"}};
  for (const CellAnalysis& cell : study.cells) table.rows.push_back(verdict_row(cell, study.level));
  return table;
}

TextTable accuracy_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},
                    {"position RMSE [m]"},
                    {"heading RMSE [deg]"},
                    {"efficiency"},
                    {"ESS"},
                    {"roots"},
                    {"CPU [s]"}};
  for (const CellAnalysis& cell : study.cells)
    table.rows.push_back(accuracy_row(cell, study.level));
  return table;
}

TextTable consistency_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},
                    {"error", Align::left},
                    {"covariance", Align::left},
                    {"verdict", Align::left},
                    {"ANEES"},
                    {"/ expected [" + level_text(study.level) + "]"},
                    {"median / expected"},
                    {"trimmed / expected"},
                    {"ideal"},
                    {level_text(study.level) + " band"},
                    {"inside"},
                    {"above"},
                    {"below"},
                    {"lower rank"},
                    {"unusable"},
                    {"too few draws"},
                    {"unjudged runs"}};
  for (const CellAnalysis& cell : study.cells) {
    for (const NeesResult& nees : cell.nees) {
      table.rows.push_back(consistency_row(cell, nees, study.level));
    }
  }
  return table;
}

TextTable failure_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left}, {"run"}, {"step"}, {"reason", Align::left}};
  for (const CellAnalysis& cell : study.cells) {
    for (const FailedRun& failure : cell.failures) {
      table.rows.push_back(
          {cell.label, std::to_string(failure.run), std::to_string(failure.step), failure.reason});
    }
  }
  return table;
}

std::string text_of_mean(const std::vector<double>& values, double mean, const Interval& interval,
                         double factor, double level) {
  if (!is_heavy_tailed(values)) {
    return with_interval(factor * mean, {factor * interval.lower, factor * interval.upper});
  }
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
  const Interval middle = median_interval(sorted, level);
  return compact(factor * mean) + " (heavy tail), median " +
         with_interval(factor * median_of(values), {factor * middle.lower, factor * middle.upper});
}

}  // namespace montecarta::analysis
