// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/verdict_table.hpp"

#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/statistics/sampler_scale.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/cell_report.hpp"
#include "analysis/study/efficiency.hpp"
#include "analysis/study/imported_notes.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/prose.hpp"
#include "analysis/verdict/block_errors.hpp"
#include "analysis/verdict/gate_scale.hpp"
#include "analysis/verdict/sentence.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>

namespace montecarta::analysis {
namespace {

/// Text of the band for all complete runs; single scans may have fewer valid runs.
std::string band_text(const CellAnalysis& cell, std::size_t dimension, double level) {
  if (cell.complete == 0) return "-";
  return interval_text(nees_bounds(cell.complete, dimension, level));
}

const NeesResult* tested_pose(const CellAnalysis& cell) {
  const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
  return pose != nullptr && pose->is_tested() ? pose : nullptr;
}

/// The average NEES of an ideal filter with these moments.
double ideal_nees(const CellAnalysis& cell, const NeesResult& nees) {
  const std::size_t d = nees.series.dimension;
  const bool drawn = nees.moments == Moments::spread && cell.particles > 0;
  return drawn ? ideal_spread_nees(d, cell.particles) : static_cast<double>(d);
}

template <auto NeesSeries::*kCount>
double samples_of(const NeesResult& nees) {
  return static_cast<double>(nees.series.*kCount);
}

std::string whole_number_text(double count) { return std::to_string(std::llround(count)); }

const std::vector<ResultNumber<NeesResult>> kNeesQuantities = {
    {"share_inside", "1", &NeesResult::share_inside, "inside", percent},
    {"share_above", "1", &NeesResult::share_above, "above", percent},
    {"share_below", "1", &NeesResult::share_below, "below", percent},
    {"samples", "1", samples_of<&NeesSeries::samples>},
    {"lower_rank", "1", samples_of<&NeesSeries::lower_rank>, "singular", whole_number_text},
    {"unusable", "1", samples_of<&NeesSeries::unusable>, "unusable", whole_number_text},
    {"too_few_draws", "1", samples_of<&NeesSeries::too_few>, "too few draws", whole_number_text},
    {"unjudged_runs", "1", samples_of<&NeesSeries::unjudged_runs>, "unjudged runs",
     whole_number_text}};

/// Heading of a column of ratios with intervals at `level`.
std::string ratio_heading(const StudyAnalysis& study, double level) {
  return std::string(study.imported.name_of_ratio()) + " [" + level_text(level) + "]";
}

std::vector<TextTable::Entry> consistency_row(const StudyAnalysis& study, const CellAnalysis& cell,
                                              const NeesResult& nees) {
  const auto d = static_cast<double>(nees.series.dimension);
  Interval average = {nees.average_interval.lower / d, nees.average_interval.upper / d};
  double ratio = nees.mean / d;
  if (const auto* gate = cell.find<GateScale>()) {
    ratio = gate->factor_of(ratio);
    average = gate->factor_of(average);
  }
  std::vector<TextTable::Entry> row = {
      {"cell", cell.label, Align::left},
      {"error", name_of(nees.block), Align::left},
      {"covariance", name_of(nees.moments), Align::left},
      {"ANEES", compact(nees.mean)},
      {ratio_heading(study, study.level), ratio_with_interval(ratio, average)},
      {"ideal", readable(ideal_nees(cell, nees))},
      {level_text(study.level) + " band", band_text(cell, nees.series.dimension, study.level)}};
  add_entries(kNeesQuantities, nees, study.level, row);
  return row;
}

constexpr std::size_t kComplete = 1;  // index of the column of complete runs

/// Text of the complete runs: "40", or "32 of 200" if runs failed, are missing or were not needed.
std::string complete_runs_text(const CellAnalysis& cell) {
  const std::size_t all = cell.complete + cell.failures.size() + cell.missing + cell.not_needed;
  const std::string complete = std::to_string(cell.complete);
  return cell.complete == all ? complete : complete + " of " + std::to_string(all);
}

/// Text of the first particles that still have descendants at the end: "1.0 of 100".
std::string ancestors_text(const CellAnalysis& cell) {
  const std::string count = readable(cell.over_runs("ancestors_at_start_at_the_end").mean, 2);
  return count == "-" ? count : count + " of " + std::to_string(cell.particles);
}

/// Leaves out column `c` if all its entries are `text`.
void leave_out(std::size_t c, const std::string& text, TextTable& table) {
  if (!std::ranges::all_of(table.rows, [&](const TableRow& row) { return row[c] == text; })) return;
  const auto place = static_cast<std::ptrdiff_t>(c);
  table.headings.erase(table.headings.begin() + place);
  for (TableRow& row : table.rows) row.erase(row.begin() + place);
}

}  // namespace

Frame::Row numbers_of(const CellAnalysis& cell, const NeesResult& nees, double level) {
  const std::size_t dimension = nees.series.dimension;
  const Interval band = nees_bounds(cell.complete, dimension, level);
  Frame::Row row = {{"level", "1", level},
                    {"dimension", "1", static_cast<double>(dimension)},
                    {"anees_mean", "1", nees.mean},
                    {"anees_mean_lower", "1", nees.average_interval.lower},
                    {"anees_mean_upper", "1", nees.average_interval.upper},
                    {"lower", "1", band.lower},
                    {"upper", "1", band.upper}};
  add_numbers(kNeesQuantities, &nees, row);
  return row;
}

std::string ratio_heading(const StudyAnalysis& study) {
  const bool is_of_innovations = study.imported.are_innovations() && !study.cells.empty();
  const double level = is_of_innovations ? study.cells.front().verdict.level : study.level;
  return ratio_heading(study, level);
}

std::string ratio_text_of(const Verdict& verdict) {
  if (verdict.beside.repeated_runs > 0) return "-";
  return ratio_with_interval(verdict.ratio_estimate(), verdict.ratio());
}

std::string ratio_text(const CellAnalysis& cell) {
  return tested_pose(cell) == nullptr ? "-" : ratio_text_of(cell.verdict);
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
  if (cell.not_needed == 0 && cell.analyses_planned == 0) return words;
  const std::size_t made = cell.complete + cell.failures.size();
  const std::string analysis = ", interim analysis " + std::to_string(cell.analyses_made) + " of " +
                               std::to_string(cell.analyses_planned);
  if (cell.not_needed == 0) return words + analysis;
  return words + ", stopped at " + std::to_string(made) + " of " +
         std::to_string(made + cell.missing + cell.not_needed) + ": " +
         (cell.analyses_planned > 0 ? "verdict known" + analysis : "precise enough");
}

Tone tone_of(Answer answer) {
  if (answer == Answer::consistent) return Tone::good;
  return answer == Answer::optimistic || answer == Answer::inconsistent ? Tone::bad : Tone::plain;
}

Tone tone_of(const Verdict& verdict) {
  if (verdict.beside.repeated_runs > 0) return Tone::plain;
  if (!verdict.beside.exact.empty()) return Tone::bad;
  return verdict.is_slight() ? Tone::plain : tone_of(verdict.answer);
}

Tone tone_of_runs(const CellAnalysis& cell) {
  return cell.failures.empty() ? Tone::plain : Tone::bad;
}

TextTable verdict_table(const StudyAnalysis& study) {
  return cell_table(study, [&](const CellAnalysis& cell) -> std::vector<TextTable::Entry> {
    const NeesResult* pose = tested_pose(cell);
    return {{"runs", runs_in_words(cell), Align::left, tone_of_runs(cell)},
            {"verdict", in_words(cell.verdict), Align::left, tone_of(cell.verdict)},
            {ratio_heading(study), ratio_text(cell)},
            {"scans in band", pose == nullptr ? "-" : percent(pose->share_inside())}};
  });
}

TextTable accuracy_table(const StudyAnalysis& study) {
  return cell_table(study, [&](const CellAnalysis& cell) -> std::vector<TextTable::Entry> {
    const auto mean = [&](const char* score) { return readable(cell.over_runs(score).mean); };
    return {
        {"position RMSE [m]", score_text(cell, "position_rmse", study.level).text()},
        {"heading RMSE [deg]", score_text(cell, "heading_rmse", study.level, 180.0 / kPi).text()},
        {"efficiency", percent(cell.get<Efficiency>().position)},
        {"ESS", mean("ess")},
        {"ancestors", mean("ancestors_at_start_at_the_end")},
        {"CPU [s]", mean("cpu_seconds")}};
  });
}

TextTable consistency_table(const StudyAnalysis& study) {
  TextTable table{.keys = 3};
  for (const CellAnalysis& cell : study.cells) {
    for (const NeesResult& nees : cell.nees) table.add(consistency_row(study, cell, nees));
  }
  return table;
}

Frame::Row family_row(const FamilyTest& test, const Member& member) {
  return {{"from", "s", member.from},
          {"to", "s", member.to},
          {"estimate", "1", member.estimate},
          {"lower", "1", member.interval.lower},
          {"upper", "1", member.interval.upper},
          {"simultaneous_lower", "1", member.simultaneous.lower},
          {"simultaneous_upper", "1", member.simultaneous.upper},
          {"p", "1", member.p},
          {"family_p", "1", test.p},
          {"shown", "1", test.is_shown(member) ? 1.0 : 0.0}};
}

Frame family_frame(const FamilyTest& test) {
  Frame frame;
  for (const Member& member : test.members) frame.add(family_row(test, member));
  return frame;
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
  const double each = study.cells.empty() ? study.level : study.cells.front().verdict.level;
  if (study.imported.are_innovations()) {
    return prose("verdict", "ratio of innovations",
                 {{"components", components_text(study)},
                  {"each", level_text(each)},
                  {"level", level_text(study.level)}});
  }
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
  add("notes", {{"level", level_text(study.level)}});
  if (study.runs_at_analyses.size() > 1) {
    add("interim analyses", {{"analyses", std::to_string(study.runs_at_analyses.size())},
                             {"first", std::to_string(study.runs_at_analyses[0])},
                             {"error", level_text(1.0 - study.level)}});
  }
  return notes;
}

std::optional<double> shown_for_twice(const CellAnalysis& cell) {
  const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
  if (pose == nullptr || pose->moments != Moments::corrected) return std::nullopt;
  const double ess = cell.over_runs("ess").mean;
  const auto all = static_cast<double>(cell.particles);
  const EffectiveDraws draws = effective_draws(cell.particles, std::isnan(ess) ? all : ess);
  const SamplerScale& scale = sampler_scale(pose->series.dimension);
  if (!scale.can_judge(draws)) return std::nullopt;
  return scale.shown_ratio(2.0, draws);
}

std::vector<std::string> cautions(std::span<const CellAnalysis> cells,
                                  const ImportedState& imported) {
  constexpr double kLeastShare = 0.01;
  std::string runs, draws, singular, twice;
  const auto list = [](std::string& text, const CellAnalysis& cell, const std::string& count) {
    append_part(text, cell.label + " " + count);
  };
  for (const CellAnalysis& cell : cells) {
    const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
    if (pose == nullptr) continue;
    const auto shown = shown_for_twice(cell);
    if (shown && *shown <= 2.0 * (1.0 - kLeastShare)) list(twice, cell, compact(*shown));
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
  add("few particles", twice);
  return sentences;
}

TextTable summary_table(const StudyAnalysis& study) {
  TextTable table;
  const std::string ratio = ratio_heading(study);
  const auto entry_of = [](const Verdict& verdict) -> TextTable::Entry {
    return {"verdict", answer_in_words(verdict), Align::left, tone_of(verdict)};
  };
  for (const CellAnalysis& cell : study.cells) {
    const auto mean = [&](const char* score) { return cell.over_runs(score).mean; };
    table.add({{"cell", cell.label, Align::left},
               {"complete", complete_runs_text(cell)},
               entry_of(cell.verdict),
               {ratio, ratio_text(cell)},
               {"RMSE [m]", readable(mean("position_rmse"))},
               {"RMSE [deg]", readable(180.0 / kPi * mean("heading_rmse"))},
               {"ancestors", ancestors_text(cell)},
               {"CPU/run [s]", readable(mean("cpu_seconds"), 2)}});
    for (const BlockVerdict& block : cell.get<std::vector<BlockVerdict>>()) {
      table.add({{"cell", "  " + block.name, Align::left},
                 {"complete", complete_runs_text(cell)},
                 entry_of(block.verdict),
                 {ratio, ratio_text_of(block.verdict)},
                 {"RMSE [m]", "-"},
                 {"RMSE [deg]", "-"},
                 {"ancestors", "-"},
                 {"CPU/run [s]", "-"}});
    }
  }
  for (std::size_t c = table.headings.size() - 1; c > kComplete; --c) leave_out(c, "-", table);
  leave_out(kComplete, std::to_string(study.runs_here), table);
  return table;
}

}  // namespace montecarta::analysis
