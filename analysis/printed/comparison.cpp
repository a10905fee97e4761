// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/printed/comparison.hpp"

#include "analysis/output/number_text.hpp"
#include "analysis/printed/run_samples.hpp"
#include "analysis/statistics/means.hpp"
#include "analysis/statistics/spread.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace montecarta::analysis {
namespace {

/// Without runs to tell chance from difference, this near is near.
constexpr double kNearWithoutInterval = 0.2;
constexpr std::string_view kNotReproduced = "not reproduced";

std::string factor_text(double factor) {
  const std::string how = factor >= 1.0 ? " times as large" : " times smaller";
  return readable(factor >= 1.0 ? factor : 1.0 / factor, 2) + how;
}

std::string distance_text(double measured, double printed) {
  if (!std::isfinite(measured)) return std::string(kNotReproduced) + ": never";
  const double factor = measured / printed;
  if (!(factor > 0.0) || !std::isfinite(factor)) return "differs";
  const bool far = factor > kReproducedWithin || factor < 1.0 / kReproducedWithin;
  return (far ? std::string(kNotReproduced) + ": " : "differs: ") + factor_text(factor);
}

/// Whether one run more could well be the printed one: not among our most extreme (1 - level).
bool is_among(const std::vector<double>& runs, const PrintedValue& value, double level) {
  const double number = value.number(), rounding = value.rounding();
  const auto below = std::ranges::count_if(runs, [&](double v) { return v <= number + rounding; });
  const auto above = std::ranges::count_if(runs, [&](double v) { return v >= number - rounding; });
  const double least = 0.5 * (1.0 - level) * static_cast<double>(runs.size());
  return static_cast<double>(std::min(below, above)) >= std::max(1.0, least);
}

std::string verdict_on(const PrintedValue& value, std::uint64_t paper_runs, const Sample& sample,
                       double level) {
  const double off = std::abs(sample.mean - value.number());
  if (off <= value.rounding()) return "agrees";
  if (sample.n < 2) {
    const bool near = off <= kNearWithoutInterval * std::abs(value.number());
    return near ? "agrees within 20 %" : distance_text(sample.mean, value.number());
  }
  if (paper_runs <= 1 && !sample.values.empty() && !is_among(sample.values, value, level)) {
    return distance_text(sample.mean, value.number());
  }
  const double n = static_cast<double>(sample.n);
  const double N = static_cast<double>(std::max<std::uint64_t>(1, paper_runs));
  const double reach = t_quantile(sample.n, level) * sample.sd * std::sqrt(1.0 / n + 1.0 / N);
  return off <= value.rounding() + reach ? "agrees" : distance_text(sample.mean, value.number());
}

/// Of a difference known by its interval alone.
std::string verdict_on(char relation, const Interval& difference, double scale) {
  if (relation == '~') {
    const double near = kAlikeWithin * scale;
    if (difference.lower > -near && difference.upper < near) return "holds";
    return difference.lower > near || difference.upper < -near ? "contradicted" : "undecided";
  }
  const bool below = difference.upper<0.0, above = difference.lower> 0.0;
  if (!below && !above) return "undecided";
  return below == (relation == '<') ? "holds" : "contradicted";
}

std::uint64_t paper_runs_of(const StudyAnalysis& study, const PrintedValue& value) {
  return value.runs == 0 ? study.printed.runs : value.runs;
}

/// Whether the printed number lies among those of batches; beside their median where not.
std::string verdict_on(const PrintedValue& value, const BatchSpread& spread) {
  const double number = value.number(), rounding = value.rounding();
  const bool is_among =
      number >= spread.range.lower - rounding && number <= spread.range.upper + rounding;
  return is_among ? "agrees" : distance_text(spread.median, number);
}

std::string measured_text(double value) { return std::isinf(value) ? "never" : readable(value, 4); }

const CellAnalysis* cell_named(const StudyAnalysis& study, const std::string& label) {
  const auto found = std::ranges::find(study.cells, label, &CellAnalysis::label);
  return found == study.cells.end() ? nullptr : &*found;
}

/// By the paper's band where it printed one, else by that of so many runs.
std::vector<double> batches_by_paper(const CellAnalysis* cell, const std::string& metric,
                                     std::uint64_t runs) {
  std::vector<double> values = batches_of(cell, metric, runs, BatchBand::printed);
  return values.empty() ? batches_of(cell, metric, runs, BatchBand::expected) : values;
}

/// Adds what batches of the paper's size say, which decides where runs have no number each.
void compare_batches(const StudyAnalysis& study, const PrintedValue& value,
                     const CellAnalysis* cell, ComparedValue& compared) {
  if (!value.relative_to.empty()) return;
  const std::uint64_t runs = std::max<std::uint64_t>(1, paper_runs_of(study, value));
  compared.batches = spread_of_batches(batches_by_paper(cell, value.metric, runs), study.level);
  if (is_run_metric(value.metric) || compared.batches.batches == 0) return;
  compared.by_expected =
      spread_of_batches(batches_of(cell, value.metric, runs, BatchBand::expected), study.level);
  compared.measured = compared.batches.median;
  compared.interval = {kNaN, kNaN};
  compared.verdict = verdict_on(value, compared.batches);
}

ComparedValue compare_alone(const StudyAnalysis& study, const PrintedValue& value) {
  const CellAnalysis* cell = cell_named(study, value.cell);
  const CellAnalysis* unit = cell_named(study, value.relative_to);
  const Sample sample = value.relative_to.empty() ? sample_of(cell, value.metric)
                                                  : ratio_of(cell, unit, value.metric);
  ComparedValue compared{sample.mean, interval_of(sample, study.level), "not measured"};
  if (std::isnan(sample.mean)) return compared;
  compared.verdict = verdict_on(value, paper_runs_of(study, value), sample, study.level);
  compare_batches(study, value, cell, compared);
  return compared;
}

/// The baseline's own number of this metric, where it is off by so much that no other compares.
std::optional<std::string> other_world(const StudyAnalysis& study, const PrintedValue& value) {
  const std::string& baseline = study.printed.baseline;
  if (baseline.empty() || value.cell == baseline) return std::nullopt;
  for (const PrintedValue& other : study.printed.values) {
    if (other.cell != baseline || other.metric != value.metric) continue;
    const std::string verdict = compare_alone(study, other).verdict;
    if (verdict.starts_with(kNotReproduced)) {
      return "another world: " + baseline + verdict.substr(kNotReproduced.size());
    }
  }
  return std::nullopt;
}

/// Of a number that all runs of a batch have together; nothing without two batches of both cells.
std::optional<ComparedClaim> claim_by_batches(const StudyAnalysis& study,
                                              const PrintedClaim& claim) {
  if (is_run_metric(claim.metric) || claim.relation == '~') return std::nullopt;
  const auto batches = [&](const std::string& label) {
    return batches_by_paper(cell_named(study, label), claim.metric, study.printed.runs);
  };
  const BatchClaim found =
      claim_over_batches(batches(claim.left), batches(claim.right), claim.relation);
  if (found.batches < 2) return std::nullopt;
  return ComparedClaim{
      found.difference, {kNaN, kNaN}, found.batches * study.printed.runs, in_words(found)};
}

}  // namespace

ComparedValue compare(const StudyAnalysis& study, const PrintedValue& value) {
  ComparedValue compared = compare_alone(study, value);
  if (const auto other = other_world(study, value)) compared.verdict = *other;
  return compared;
}

ComparedClaim compare(const StudyAnalysis& study, const PrintedClaim& claim) {
  if (const auto batches = claim_by_batches(study, claim)) return *batches;
  const CellAnalysis* left = cell_named(study, claim.left);
  const CellAnalysis* right = cell_named(study, claim.right);
  const Sample difference = difference_of(left, right, claim.metric);
  ComparedClaim compared{difference.mean, interval_of(difference, study.level), difference.n,
                         "not measured"};
  if (std::isnan(difference.mean)) return compared;
  const double scale = 0.5 * (std::abs(sample_of(left, claim.metric).mean) +
                              std::abs(sample_of(right, claim.metric).mean));
  const bool sure = difference.n >= 2;
  const Interval alone{difference.mean, difference.mean};
  compared.verdict = verdict_on(claim.relation, sure ? compared.interval : alone, scale);
  if (!sure && compared.verdict != "undecided") compared.verdict += ", without interval";
  return compared;
}

TextTable printed_value_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},
                    {"what", Align::left},
                    {"paper printed"},
                    {"we measure"},
                    {level_text(study.level) + " interval"},
                    {"batches: median [" + level_text(study.level) + "]"},
                    {"by the expected band"},
                    {"verdict", Align::left},
                    {"where", Align::left}};
  for (const PrintedValue& value : study.printed.values) {
    const ComparedValue compared = compare(study, value);
    const std::string per = value.relative_to.empty() ? "" : ", in those of " + value.relative_to;
    table.rows.push_back({value.cell, metric_in_words(value.metric) + per, value.printed,
                          measured_text(compared.measured), interval_text(compared.interval),
                          in_words(compared.batches), in_words(compared.by_expected),
                          compared.verdict, value.note});
  }
  return table;
}

TextTable printed_claim_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"paper says", Align::left},
                    {"we measure: left - right"},
                    {level_text(study.level) + " interval"},
                    {"runs"},
                    {"verdict", Align::left},
                    {"where", Align::left}};
  for (const PrintedClaim& claim : study.printed.claims) {
    const ComparedClaim compared = compare(study, claim);
    const std::string difference =
        std::isinf(compared.difference) ? "one of them never" : readable(compared.difference);
    table.rows.push_back({metric_in_words(claim.metric) + ": " + claim.left + " " + claim.relation +
                              " " + claim.right,
                          difference, interval_text(compared.interval),
                          compared.runs < 2 ? "-" : std::to_string(compared.runs), compared.verdict,
                          claim.note});
  }
  return table;
}

std::vector<std::string> printed_notes(const StudyAnalysis& study) {
  const std::string level = level_text(study.level);
  const std::string of =
      study.printed.runs == 0
          ? "The paper does not say of how many runs its numbers are: one is assumed."
          : "The paper's numbers are of " + std::to_string(study.printed.runs) + " runs.";
  return {
      of + " 'agrees' means that the printed number lies where " + level +
          " of the means of so many runs of ours lie; 'not reproduced' is off by more than a "
          "factor "
          "of " +
          readable(kReproducedWithin, 1) + ". The interval is that of our mean.",
      "A claim 'holds' or is 'contradicted' where the whole " + level +
          " interval of the difference, run by run on the same worlds and noise, lies on one "
          "side; '~' claims less than 10 % difference. A number that all runs have together has "
          "no interval.",
      "'Batches' are our runs in groups of as many as the paper had: the median over them, and "
      "where " +
          level +
          " of them lie (of fewer than 40 all). Times and shares of a band, which depend on the "
          "number of runs, are compared with them, by the band that the paper printed; beside it "
          "by that which so many runs of a consistent filter have. 'Another world': the baseline "
          "itself is off by more than a factor of " +
          readable(kReproducedWithin, 1) + ", so that no number of its column compares."};
}

}  // namespace montecarta::analysis
