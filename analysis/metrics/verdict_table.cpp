// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/verdict_table.hpp"

#include "analysis/metrics/cramer_rao.hpp"
#include "analysis/metrics/imported_estimates.hpp"
#include "analysis/metrics/nees.hpp"
#include "analysis/metrics/survival.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/spread.hpp"
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

namespace {

std::string anees_note(const StudyAnalysis& study, const std::string& level) {
  const std::string dimension = std::to_string(study.imported.components.size());
  return "ANEES compares the errors that happened with the errors the filter expected (its "
         "covariance), averaged over runs and scans: " +
         dimension +
         " means it knows how wrong it is (as many components: " + components_text(study) +
         "), more means it is overconfident, less that it is conservative. '/ expected' divides it "
         "by " +
         dimension + "; the brackets hold what infinitely many runs would give in at least " +
         level +
         " of studies. Where a few runs decide the mean no interval holds it: 'heavy tail', and "
         "the median over runs follows with its interval. 'Would find' is the least ratio that "
         "this study finds with a probability of " +
         level_text(kPowerSaid) + ".";
}

std::string looks_note(const StudyAnalysis& study) {
  return "A cell of this study stops when its verdict is known, which is looked at after up to " +
         std::to_string(study.looks.size()) + " numbers of runs, " +
         std::to_string(study.looks[0]) +
         " first. Brackets and bands of the verdict are widened so that all looks together "
         "reject a consistent filter in at most " +
         level_text(1.0 - study.level) + " of studies. Those of other numbers are not.";
}

}  // namespace

std::vector<std::string> verdict_notes(const StudyAnalysis& study) {
  const std::string level = level_text(study.level), margin = exact_text(study.within);
  std::vector<std::string> notes = {
      anees_note(study, level),
      "'NEES of particles' is by the spread of the poses that a scan drew, on the scale on which a "
      "perfect filter of as many draws has 3, as a Gaussian filter has: all rows of this table are "
      "on one scale.",
      "'Consistent within " + margin + "': the brackets lie between 1/" + margin + " and " +
          margin +
          ", and no scan is shown to be farther off. 'Optimistic' or 'conservative by a to b': 1 "
          "is outside the brackets or, 'at t', a scan is outside a band that is wide enough for "
          "all scans together; a consistent filter is rejected so in at most " +
          level_text(1.0 - study.level) +
          " of studies, however long they are. 'Undecided': neither is shown; after so many more "
          "runs one of them will be, if runs go on to vary as they do.",
      "'Outside to the end from': all scans from then on are outside the band for all scans, so "
      "that, with a probability of " +
          level +
          ", the filter is off at every one of them; it may be so earlier. 'Never' means not "
          "within the " +
          readable(study.duration, 4) +
          " s of this study. A single run is lost when its own NEES is above its band for " +
          std::to_string(kLastingScans) + " scans in a row, or when it fails.",
      "'scans inside' counts the scans whose average lies in the pointwise band: " + level +
          " of them are expected of a consistent filter, and neighbouring scans are correlated.",
      "RMSE is the mean over runs, with the interval that holds it for infinitely many; ESS is the "
      "effective number of particles, roots how many of the first particles still have descendants "
      "at the end, CPU the filter's own time in a run; all of complete runs only."};
  if (study.looks.size() > 1) notes.push_back(looks_note(study));
  return notes;
}

std::vector<std::string> consistency_notes() {
  return {
      "Each row is one test: of the pose or of a part of it. The first covariance of a cell "
      "decides its verdict: the only one of a Kalman filter, 'corrected' of a particle filter. "
      "Only these are on one scale.",
      "The spread of few particles is too small by construction, and so is the mixture: 'ideal' is "
      "the ANEES of a perfect filter, the number of components or, by the spread of M particles "
      "that are independent draws from the truth's distribution, more. 'corrected' puts the NEES "
      "by the spread of the poses that a scan drew on a scale on which such a perfect filter has "
      "the number of components again (Hotelling's distribution of the effective number of draws "
      "to the chi-square), so that few draws alone make no filter optimistic. Where a scan drew "
      "none it is that of the mixture.",
      "'median' is the middle run instead of the average one, 'trimmed' the mean without the tenth "
      "of the runs at either end, each divided by what a consistent filter has: near 1 while ANEES "
      "is far too large they say that few bad runs make the average. 'lower rank' counts singular "
      "covariances: they are judged by the components that they leave. 'unusable' counts samples "
      "that are left out because error or covariance is not finite or the covariance is not "
      "positive semidefinite. 'too few draws' counts covariances of no more effective draws than "
      "components and two, of which no spread says anything, 'unjudged runs' complete runs in "
      "which no scan is left."};
}

std::vector<std::string> too_few_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  for (const CellAnalysis& cell : study.cells) {
    const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
    if (pose == nullptr) continue;
    if (pose->series.unjudged_runs > 0) {
      notes.push_back(cell.label + ": " + std::to_string(pose->series.unjudged_runs) + " of " +
                      std::to_string(cell.complete) +
                      " complete runs have no scan that can be judged; ANEES and verdict are of "
                      "the other runs.");
    }
    if (pose->series.too_few == 0) continue;
    const double share =
        static_cast<double>(pose->series.too_few) / static_cast<double>(pose->series.samples);
    notes.push_back(cell.label + ": in " + std::to_string(pose->series.too_few) + " of " +
                    std::to_string(pose->series.samples) + " scans (" + percent(share) +
                    ") the weights leave no more than 5 effective draws (ESS), of which a "
                    "covariance of three components cannot be judged; ANEES and verdict are of "
                    "the other scans.");
  }
  return notes;
}

}  // namespace montecarta::analysis
