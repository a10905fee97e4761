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
#include <iterator>

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

std::vector<TextTable::Entry> verdict_row(const CellAnalysis& cell, double level) {
  const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
  const bool is_tested = pose != nullptr && pose->is_tested();
  return {{"cell", cell.label, Align::left},
          {"runs", runs_in_words(cell), Align::left},
          {"verdict", in_words(cell.verdict), Align::left},
          {"NEES ratio [" + level_text(level) + "]", ratio_text(cell)},
          {"scans in band", is_tested ? percent(pose->share_inside()) : "-"},
          {"median time of loss", median_exit_text(cell)}};
}

std::vector<TextTable::Entry> accuracy_row(const CellAnalysis& cell, double level) {
  return {{"cell", cell.label, Align::left},
          {"position RMSE [m]", score_text(cell, "position_rmse", level).text()},
          {"heading RMSE [deg]", score_text(cell, "heading_rmse", level, 180.0 / kPi).text()},
          {"efficiency", percent(cell.get<Efficiency>().position)},
          {"ESS", readable(cell.over_runs("ess").mean)},
          {"ancestors", readable(cell.over_runs("ancestors_at_start_at_the_end").mean)},
          {"CPU [s]", readable(cell.over_runs("cpu_seconds").mean)}};
}

/// The average of an ideal filter with these moments.
double ideal_nees(const CellAnalysis& cell, const NeesResult& nees) {
  const std::size_t d = nees.series.dimension;
  const bool drawn = nees.moments == Moments::spread && cell.particles > 0;
  return drawn ? ideal_spread_nees(d, cell.particles) : static_cast<double>(d);
}

std::vector<TextTable::Entry> consistency_row(const CellAnalysis& cell, const NeesResult& nees,
                                              double level) {
  const auto d = static_cast<double>(nees.series.dimension);
  const Interval& average = nees.average_interval;
  const std::string of_level = level_text(level);
  return {{"cell", cell.label, Align::left},
          {"error", name_of(nees.block), Align::left},
          {"covariance", name_of(nees.moments), Align::left},
          {"ANEES", compact(nees.mean)},
          {"NEES ratio [" + of_level + "]",
           with_interval(nees.mean / d, {average.lower / d, average.upper / d})},
          {"ideal", readable(ideal_nees(cell, nees))},
          {of_level + " band", band_text(cell, nees.series.dimension, level)},
          {"inside", percent(nees.share_inside())},
          {"above", percent(nees.share_above)},
          {"below", percent(nees.share_below)},
          {"singular", std::to_string(nees.series.lower_rank)},
          {"unusable", std::to_string(nees.series.unusable)},
          {"too few draws", std::to_string(nees.series.too_few)},
          {"unjudged runs", std::to_string(nees.series.unjudged_runs)}};
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
  for (const CellAnalysis& cell : study.cells) table.add(verdict_row(cell, study.level));
  return table;
}

TextTable accuracy_table(const StudyAnalysis& study) {
  TextTable table;
  for (const CellAnalysis& cell : study.cells) table.add(accuracy_row(cell, study.level));
  return table;
}

TextTable consistency_table(const StudyAnalysis& study) {
  TextTable table{.keys = 3};
  for (const CellAnalysis& cell : study.cells) {
    for (const NeesResult& nees : cell.nees) table.add(consistency_row(cell, nees, study.level));
  }
  return table;
}

std::vector<NamedSeries> family_columns(const FamilyTest& test) {
  std::vector<NamedSeries> columns;
  for (const Member& member : test.members) {
    const std::vector<NamedNumber> row = {{"from", "s", member.from},
                                          {"to", "s", member.to},
                                          {"estimate", "1", member.estimate},
                                          {"lower", "1", member.interval.lower},
                                          {"upper", "1", member.interval.upper},
                                          {"simultaneous_lower", "1", member.simultaneous.lower},
                                          {"simultaneous_upper", "1", member.simultaneous.upper},
                                          {"p", "1", member.p},
                                          {"family_p", "1", test.p},
                                          {"shown", "1", test.is_shown(member) ? 1.0 : 0.0}};
    if (columns.empty()) {
      for (const NamedNumber& one : row) columns.push_back({one.name, one.units, {}});
    }
    for (std::size_t c = 0; c < row.size(); ++c) columns[c].values.push_back(row[c].value);
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
  return prose("verdict", "ratio",
               {{"components", components_text(study)}, {"level", level_text(study.level)}});
}

std::string answers_note(const StudyAnalysis& study) {
  return prose("verdict", "answers",
               {{"margin", exact_text(study.within)}, {"error", level_text(1.0 - study.level)}});
}

std::vector<std::string> verdict_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes = {ratio_note(study), answers_note(study)};
  const auto add = [&](const char* key, const Values& values) {
    std::ranges::move(paragraphs("verdict", key, values), std::back_inserter(notes));
  };
  add("notes", {{"level", level_text(study.level)}, {"lasting", std::to_string(kLastingScans)}});
  if (study.looks.size() > 1) {
    add("looks", {{"looks", std::to_string(study.looks.size())},
                  {"first", std::to_string(study.looks[0])},
                  {"error", level_text(1.0 - study.level)}});
  }
  return notes;
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
  const auto add = [&](const char* key, const std::string& affected) {
    if (!affected.empty()) sentences.push_back(prose("verdict", key, {{"cells", affected}}));
  };
  add("unjudged", runs);
  add("draws", draws);
  add("singular", singular);
  return sentences;
}

}  // namespace montecarta::analysis
