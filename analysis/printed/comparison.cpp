// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/printed/comparison.hpp"

#include "analysis/output/number_text.hpp"
#include "analysis/printed/run_samples.hpp"
#include "analysis/statistics/t_quantile.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

/// Without runs to tell chance from difference, this near is near.
constexpr double kNearWithoutInterval = 0.2;

std::string factor_text(double factor) {
  const std::string how = factor >= 1.0 ? " times as large" : " times smaller";
  return readable(factor >= 1.0 ? factor : 1.0 / factor, 2) + how;
}

std::string distance_text(double measured, double printed) {
  if (!std::isfinite(measured)) return "not reproduced: never";
  const double factor = measured / printed;
  if (!(factor > 0.0) || !std::isfinite(factor)) return "differs";
  const bool far = factor > kReproducedWithin || factor < 1.0 / kReproducedWithin;
  return (far ? "not reproduced: " : "differs: ") + factor_text(factor);
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

std::string measured_text(double value) { return std::isinf(value) ? "never" : readable(value, 4); }

const CellAnalysis* cell_named(const StudyAnalysis& study, const std::string& label) {
  const auto found = std::ranges::find(study.cells, label, &CellAnalysis::label);
  return found == study.cells.end() ? nullptr : &*found;
}

}  // namespace

ComparedValue compare(const StudyAnalysis& study, const PrintedValue& value) {
  const CellAnalysis* cell = cell_named(study, value.cell);
  const CellAnalysis* unit = cell_named(study, value.relative_to);
  const Sample sample = value.relative_to.empty() ? sample_of(cell, value.metric)
                                                  : ratio_of(cell, unit, value.metric);
  ComparedValue compared{sample.mean, interval_of(sample, study.level), "not measured"};
  if (std::isnan(sample.mean)) return compared;
  const std::uint64_t runs = value.runs == 0 ? study.printed.runs : value.runs;
  compared.verdict = verdict_on(value, runs, sample, study.level);
  return compared;
}

ComparedClaim compare(const StudyAnalysis& study, const PrintedClaim& claim) {
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
                    {"verdict", Align::left},
                    {"where", Align::left}};
  for (const PrintedValue& value : study.printed.values) {
    const ComparedValue compared = compare(study, value);
    const std::string per = value.relative_to.empty() ? "" : ", in those of " + value.relative_to;
    table.rows.push_back({value.cell, metric_in_words(value.metric) + per, value.printed,
                          measured_text(compared.measured), interval_text(compared.interval),
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
          "no interval."};
}

}  // namespace montecarta::analysis
