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
#include <array>

namespace montecarta::analysis {
namespace {

/// The band of all complete runs: single scans may have fewer valid ones.
std::string band_text(const CellAnalysis& cell, std::size_t dimension, double level) {
  if (cell.complete == 0) return "-";
  return interval_text(nees_bounds(cell.complete, dimension, level));
}

std::string median_exit_text(const CellAnalysis& cell) {
  const Survival& survival = cell.get<Survival>();
  if (survival.runs == 0) return "-";
  return time_with_interval(survival.median, survival.median_interval);
}

std::vector<std::string> verdict_row(const CellAnalysis& cell) {
  const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
  const bool is_tested = pose != nullptr && pose->is_tested();
  return {cell.label,
          runs_in_words(cell),
          in_words(cell.verdict),
          ratio_text(cell),
          is_tested ? percent(pose->share_inside()) : "-",
          median_exit_text(cell)};
}

std::vector<std::string> accuracy_row(const CellAnalysis& cell, double level) {
  return {cell.label,
          score_text(cell, "position_rmse", level).text(),
          score_text(cell, "heading_rmse", level, 180.0 / kPi).text(),
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
  const auto d = static_cast<double>(nees.series.dimension);
  const Interval& average = nees.average_interval;
  return {cell.label,
          name_of(nees.block),
          name_of(nees.moments),
          compact(nees.mean),
          with_interval(nees.mean / d, {average.lower / d, average.upper / d}),
          readable(ideal_nees(cell, nees)),
          band_text(cell, nees.series.dimension, level),
          percent(nees.share_inside()),
          percent(nees.share_above),
          percent(nees.share_below),
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
  const std::size_t dimension = nees.series.dimension;
  const Interval band = nees_bounds(cell.complete, dimension, level);
  return {{"level", "1", level},
          {"dimension", "1", static_cast<double>(dimension)},
          {"anees_mean", "1", nees.mean},
          {"anees_mean_lower", "1", nees.average_interval.lower},
          {"anees_mean_upper", "1", nees.average_interval.upper},
          {"lower", "1", band.lower},
          {"upper", "1", band.upper},
          {"share_inside", "1", nees.share_inside()},
          {"share_above", "1", nees.share_above},
          {"share_below", "1", nees.share_below},
          {"samples", "1", static_cast<double>(nees.series.samples)},
          {"lower_rank", "1", static_cast<double>(nees.series.lower_rank)},
          {"unusable", "1", static_cast<double>(nees.series.unusable)},
          {"too_few_draws", "1", static_cast<double>(nees.series.too_few)},
          {"unjudged_runs", "1", static_cast<double>(nees.series.unjudged_runs)}};
}

std::string ratio_text(const CellAnalysis& cell) {
  const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
  if (pose == nullptr || !pose->is_tested()) return "-";
  return with_interval(cell.verdict.ratio_estimate(), cell.verdict.ratio());
}

std::string MeanText::text() const {
  return median.empty() ? mean : mean + " (heavy tail), median " + median;
}

MeanText score_text(const CellAnalysis& cell, std::string_view score, double level, double factor) {
  const auto scaled = [&](const Interval& interval) {
    return Interval{factor * interval.lower, factor * interval.upper};
  };
  std::vector<double> sorted = cell.scores.column(score);
  const double mean = factor * cell.over_runs(score).mean;
  if (!is_heavy_tailed(sorted)) return {with_interval(mean, scaled(cell.interval_of(score))), ""};
  std::ranges::sort(sorted);
  return {compact(mean),
          with_interval(factor * median_of(sorted), scaled(median_interval(sorted, level)))};
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
  table.headings = {{"cell", Align::left},    {"runs", Align::left},
                    {"verdict", Align::left}, {"NEES ratio [" + level_text(study.level) + "]"},
                    {"scans in band"},        {"median time of loss"}};
  for (const CellAnalysis& cell : study.cells) table.rows.push_back(verdict_row(cell));
  return table;
}

TextTable accuracy_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},
                    {"position RMSE [m]"},
                    {"heading RMSE [deg]"},
                    {"efficiency"},
                    {"ESS"},
                    {"ancestors"},
                    {"CPU [s]"}};
  for (const CellAnalysis& cell : study.cells)
    table.rows.push_back(accuracy_row(cell, study.level));
  return table;
}

TextTable consistency_table(const StudyAnalysis& study) {
  TextTable table{.keys = 3};
  table.headings = {{"cell", Align::left},
                    {"error", Align::left},
                    {"covariance", Align::left},
                    {"ANEES"},
                    {"NEES ratio [" + level_text(study.level) + "]"},
                    {"ideal"},
                    {level_text(study.level) + " band"},
                    {"inside"},
                    {"above"},
                    {"below"},
                    {"singular"},
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

std::vector<NamedSeries> family_columns(const FamilyTest& test) {
  std::vector<NamedSeries> columns = {{"from", "s", {}},
                                      {"to", "s", {}},
                                      {"estimate", "1", {}},
                                      {"lower", "1", {}},
                                      {"upper", "1", {}},
                                      {"simultaneous_lower", "1", {}},
                                      {"simultaneous_upper", "1", {}},
                                      {"p", "1", {}},
                                      {"family_p", "1", {}},
                                      {"shown", "1", {}}};
  for (const Member& member : test.members) {
    const std::array<double, 10> row = {member.from,
                                        member.to,
                                        member.estimate,
                                        member.interval.lower,
                                        member.interval.upper,
                                        member.simultaneous.lower,
                                        member.simultaneous.upper,
                                        member.p,
                                        test.p,
                                        test.is_shown(member) ? 1.0 : 0.0};
    for (std::size_t c = 0; c < row.size(); ++c) columns[c].values.push_back(row[c]);
  }
  return columns;
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

std::string ratio_note(const StudyAnalysis& study) {
  return "The NEES ratio compares squared errors with what the filter's covariance says of them (" +
         components_text(study) +
         "), averaged over runs and scans: 1 is right, more is optimistic (overconfident), less is "
         "conservative. The brackets hold the ratio of infinitely many runs in at least " +
         level_text(study.level) + " of studies.";
}

std::string answers_note(const StudyAnalysis& study) {
  const std::string margin = exact_text(study.within);
  return "A cell is consistent within " + margin +
         " if this ratio, that of every component and that of every eighth of the drive are shown "
         "to lie between 1/" +
         margin + " and " + margin +
         ", and if bias and correlations are shown to be negligible. It is optimistic or "
         "conservative if squared errors are shown to be too large or too small, inconsistent if "
         "both are shown in different parts, or bias, correlation or a spread between runs alone. "
         "A consistent filter is called one of these in at most " +
         level_text(1.0 - study.level) +
         " of studies, for any number of scans and any memory of its errors. If nothing is shown "
         "the verdict is undecided, and says about how many more runs would decide.";
}

namespace {

std::string looks_note(const StudyAnalysis& study) {
  return "A cell of this study stops when its verdict is known, which is looked at after up to " +
         std::to_string(study.looks.size()) + " numbers of runs, " +
         std::to_string(study.looks[0]) +
         " first. The error probability is spent over the looks, little at the first ones "
         "(O'Brien and Fleming), so that all of them together reject a consistent filter in at "
         "most " +
         level_text(1.0 - study.level) + " of studies. Intervals of other numbers are not widened.";
}

}  // namespace

std::vector<std::string> verdict_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes = {
      ratio_note(study), answers_note(study),
      "Particle filters are judged by the spread of the poses that a scan drew, corrected for the "
      "number of effective draws, so that all rows are on one scale.",
      "'scans in band' is the share of scans whose average NEES lies in the " +
          level_text(study.level) +
          " band of a single scan; a consistent filter has that share. A run is lost when its own "
          "NEES stays above its band for " +
          std::to_string(kLastingScans) + " scans in a row, or when it fails.",
      "RMSE is the mean over runs, with a confidence interval. ESS is the effective number of "
      "particles. 'ancestors' is the number of first particles that still have descendants at the "
      "end. CPU is the time of the filter alone in a run. All are of complete runs only."};
  if (study.looks.size() > 1) notes.push_back(looks_note(study));
  return notes;
}

std::vector<std::string> consistency_notes() {
  return {
      "Each row is the average NEES of the pose, of the position or of the heading, by one "
      "covariance. The verdict uses the first covariance of a cell, which is the only one of a "
      "Kalman filter and the corrected one of a particle filter. Only these are on one scale.",
      "The spread of few particles is too small by construction, and so is the mixture. 'ideal' is "
      "the ANEES of a perfect filter with as many particles. The corrected NEES is mapped to a "
      "scale on which a perfect filter has the number of components again (from Hotelling's "
      "distribution with the effective number of draws to the chi-square distribution), so that a "
      "small number of draws makes no filter optimistic. If a scan drew no poses, it is the NEES "
      "by the mixture.",
      "'singular' counts singular covariances, which are judged by the components that they leave. "
      "'unusable' counts samples that are left out because the error or the covariance is not "
      "finite, or because the covariance is not positive semidefinite. 'too few draws' counts "
      "covariances of at most two effective draws more than components. 'unjudged runs' counts "
      "complete runs in which no scan is left."};
}

std::vector<std::string> cautions(std::span<const CellAnalysis> cells,
                                  const ImportedState& imported) {
  constexpr double kLeastShare = 0.01;
  std::string runs, draws, singular;
  const auto list = [](std::string& text, const CellAnalysis& cell, const std::string& count) {
    text += (text.empty() ? "" : ", ") + cell.label + " " + count;
  };
  for (const CellAnalysis& cell : cells) {
    const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
    if (pose == nullptr) continue;
    const NeesSeries& series = pose->series;
    const auto share = [&](std::size_t count) {
      return static_cast<double>(count) / static_cast<double>(series.samples);
    };
    if (series.unjudged_runs > 0) {
      list(runs, cell,
           std::to_string(series.unjudged_runs) + " of " + std::to_string(cell.complete));
    }
    if (share(series.too_few) >= kLeastShare) list(draws, cell, percent(share(series.too_few)));
    const double lower = share(series.lower_rank);
    if (lower >= kLeastShare && !imported.is_imported()) list(singular, cell, percent(lower));
  }
  std::vector<std::string> sentences;
  if (!runs.empty()) sentences.push_back("Runs without a scan that can be judged: " + runs + ".");
  if (!draws.empty()) {
    sentences.push_back(
        "Scans not judged, since at most 5 effective draws (ESS) give no covariance: " + draws +
        ".");
  }
  if (!singular.empty()) {
    sentences.push_back(
        "Singular covariances, judged by the components that they leave: " + singular + ".");
  }
  return sentences;
}

}  // namespace montecarta::analysis
