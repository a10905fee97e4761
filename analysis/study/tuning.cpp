// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/tuning.hpp"

#include "analysis/statistics/spread.hpp"
#include "analysis/study/prose.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

constexpr int kFactorDigits = 3;
/// Ratio of the ends of an interval from which a factor counts as not determined.
constexpr double kWideInterval = 2.0;
/// Score above the least one up to which the figure shows the landscape.
constexpr double kHighestDrawn = 10.0;

std::string factor_range_text(const Interval& interval) {
  return formatted("{} to {}", readable(interval.lower, kFactorDigits),
                   readable(interval.upper, kFactorDigits));
}

/// "2.01 times the noise of its motion (95 %: 1.97 to 2.05)".
std::string factor_words(const TunedFactor& factor, const std::string& noise,
                         const std::string& level) {
  return formatted("{} times the noise of its {} ({}{})", readable(factor.value, kFactorDigits),
                   noise, level, factor_range_text(factor.interval));
}

std::string factors_in_words(const TunedNoise& noise) {
  if (!noise.sensor.is_free()) return factor_words(noise.motion, "motion", "95 %: ");
  if (!noise.motion.is_free()) return factor_words(noise.sensor, "sensor", "95 %: ");
  return formatted("{} and {}", factor_words(noise.motion, "motion", "95 %: "),
                   factor_words(noise.sensor, "sensor", ""));
}

std::string tuned_text(const TunedFactor& factor) {
  if (!factor.is_free()) return "-";
  return formatted("{} [{}, {}]", readable(factor.value, kFactorDigits),
                   readable(factor.interval.lower, kFactorDigits),
                   readable(factor.interval.upper, kFactorDigits));
}

void add_tuned_row(const std::string& name, const std::optional<TunedNoise>& noise,
                   TextTable& table) {
  table.add({{"scans ahead", name, Align::left},
             {"factor on motion [95 %]", noise ? tuned_text(noise->motion) : "no minimum"},
             {"factor on sensor [95 %]", noise ? tuned_text(noise->sensor) : "no minimum"}});
}

/// "+4.1 %" of a logarithm.
std::string change_text(double logarithm) {
  return formatted("{}{} %", logarithm < 0.0 ? "" : "+",
                   readable(100.0 * std::expm1(logarithm), 2));
}

/// The noises on whose factors something holds: "motion", "motion and sensor"; empty if on none.
template <class Condition>
std::string noises_for_which(const TunedNoise& noise, const Condition& holds) {
  std::string names;
  if (holds(noise.motion)) names = "motion";
  if (holds(noise.sensor)) append_part(names, "sensor", " and ");
  return names;
}

bool is_flat(const TunedFactor& factor) {
  return factor.is_free() && factor.interval.upper > kWideInterval * factor.interval.lower;
}

bool exclude_each_other(const TunedFactor& a, const TunedFactor& b) {
  return a.is_free() && b.is_free() &&
         (a.interval.upper < b.interval.lower || b.interval.upper < a.interval.lower);
}

/// Returns whether two prediction intervals have factors whose intervals do not overlap.
bool depend_on_interval(const std::vector<TunedByInterval>& all) {
  for (const TunedByInterval& a : all) {
    for (const TunedByInterval& b : all) {
      if (a.noise && b.noise &&
          (exclude_each_other(a.noise->motion, b.noise->motion) ||
           exclude_each_other(a.noise->sensor, b.noise->sensor)))
        return true;
    }
  }
  return false;
}

bool has_truth(const TuningResult& result) { return result.score == TuningScore::truth; }

/// Says by what a recorded drive was scored; empty if there is a truth.
std::string score_note(const TuningResult& result) {
  const Values reference = {{"reference", result.reference}};
  switch (result.score) {
    case TuningScore::truth:
      return {};
    case TuningScore::reference:
      return prose(
          "tuning",
          result.reference_has_errors ? "scored by reference" : "scored by exact reference",
          reference);
    case TuningScore::innovations:
      break;
  }
  const bool is_unused = result.reference.empty() || result.reference_has_errors;
  return is_unused ? prose("tuning", "scored by innovations")
                   : prose("tuning", "reference without errors", reference);
}

/// Returns whether the reference has too few fixes in the second half to confirm anything.
bool is_unconfirmed(const TuningResult& result, const TuningConfirmation& confirmation) {
  return result.score == TuningScore::reference && confirmation.answer == Answer::untested;
}

/// Says how few independent errors the fixes are worth.
std::string memory_note(const TuningResult& result, const TuningConfirmation& confirmation) {
  return prose("tuning", "memory",
               {{"learned", compact(result.effective)},
                {"fixes", std::to_string(confirmation.fixes)},
                {"confirmed", compact(confirmation.effective)}});
}

std::string gain_note(const TuningResult& result, const TuningConfirmation& confirmation) {
  const std::string runs = std::to_string(confirmation.runs);
  const std::string where =
      has_truth(result)        ? formatted("{} fresh runs (seed {})", runs, confirmation.seed)
      : confirmation.runs == 1 ? "the second half of the drive"
                               : formatted("the second halves of {} drives", runs);
  const bool is_by_fixes = result.score == TuningScore::reference;
  return prose("tuning", "gain",
               {{"unit", is_by_fixes ? "fix" : "scan"},
                {"where", where},
                {"gain", with_interval(confirmation.gain.mean, confirmation.gain.interval)}});
}

/// Says how many runs the gain leaves out; empty if there is none.
std::string failed_note(const TuningResult& result, const TuningConfirmation& confirmation) {
  const std::uint64_t before = confirmation.failed_before, after = confirmation.failed_after;
  if (before + after == 0) return {};
  return prose("tuning", "failed",
               {{"runs", std::to_string(confirmation.runs) +
                             (has_truth(result) ? " fresh runs" : " recorded drives")},
                {"before", std::to_string(before)},
                {"after", std::to_string(after)}});
}

std::string cover_factor_text(double factor) {
  return std::isfinite(factor) ? readable(factor, kFactorDigits) : "no finite factor (runs failed)";
}

}  // namespace

double NoiseGrid::least() const {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& row : score) least = std::min(least, *std::ranges::min_element(row));
  return least;
}

std::vector<std::string> tuning_warnings(const TuningResult& result) {
  if (result.outliers == 0) return {};
  return {prose("tuning", "outliers",
                {{"outliers", std::to_string(result.outliers)},
                 {"fixes", std::to_string(result.fixes)},
                 {"reference", result.reference}})};
}

std::string tuning_sentence(const TuningResult& result, const TuningConfirmation& confirmation) {
  const std::string found =
      formatted("{} should assume {}.", result.cell, factors_in_words(result.noise));
  if (result.score == TuningScore::innovations)
    return formatted("{} {}", found,
                     prose("tuning", "innovations", {{"verdict", confirmation.verdict}}));
  const bool is_open =
      confirmation.answer == Answer::undecided || confirmation.answer == Answer::untested;
  if (result.score == TuningScore::reference) {
    const std::string reference =
        result.reference +
        (result.reference_has_errors ? "" : ", which states no errors of its own,");
    if (is_unconfirmed(result, confirmation)) {
      return formatted("{} {}", found,
                       prose("tuning", "unconfirmed by reference", {{"reference", reference}}));
    }
    const char* const key = confirmation.answer == Answer::consistent ? "consistent by reference"
                            : is_open                                 ? "undecided by reference"
                                      : "not consistent by reference";
    return formatted(
        "{} {}", found,
        prose("tuning", key, {{"reference", reference}, {"verdict", confirmation.verdict}}));
  }
  const char* const key = confirmation.answer == Answer::consistent ? "consistent"
                          : is_open                                 ? "undecided"
                          : confirmation.is_slight                  ? "slight"
                                                                    : "not consistent";
  return formatted(
      "{} {}", found,
      prose("tuning", key,
            {{"runs", std::to_string(confirmation.runs)}, {"verdict", confirmation.verdict}}));
}

std::vector<std::string> tuning_notes(const TuningResult& result,
                                      const TuningConfirmation& confirmation) {
  const TunedNoise& noise = result.noise;
  std::vector<std::string> notes;
  if (auto score = score_note(result); !score.empty()) notes.push_back(std::move(score));
  const bool is_confirmed = !is_unconfirmed(result, confirmation);
  if (is_confirmed) notes.push_back(gain_note(result, confirmation));
  if (result.score == TuningScore::reference) {
    if (is_confirmed) notes.push_back(memory_note(result, confirmation));
    if (result.effective < static_cast<double>(result.parts))
      notes.push_back(prose("tuning", "long memory"));
  }
  if (auto failed = failed_note(result, confirmation); !failed.empty())
    notes.push_back(std::move(failed));
  const auto note = [&](const char* key, const std::string& noises) {
    if (!noises.empty()) notes.push_back(prose("tuning", key, {{"noises", noises}}));
  };
  note("no influence",
       noises_for_which(noise, [](const TunedFactor& one) { return !one.is_free(); }));
  if (noise.motion.is_free() && noise.sensor.is_free()) {
    notes.push_back(prose("tuning", "direction",
                          {{"motion", change_text(noise.motion_apart)},
                           {"sensor", change_text(noise.sensor_apart)}}));
  }
  note("flat", noises_for_which(noise, is_flat));
  if (result.has_gate) notes.push_back(prose("tuning", "gate"));
  if (depend_on_interval(result.by_interval)) notes.push_back(prose("tuning", "not white"));
  if (has_truth(result)) {
    notes.push_back(prose("tuning", "cover",
                          {{"end", cover_factor_text(confirmation.covering_at_end)},
                           {"path", cover_factor_text(confirmation.covering_path)}}));
  }
  return notes;
}

TextTable tuning_table(const TuningResult& result) {
  TextTable table;
  for (const TunedByInterval& one : result.by_interval)
    add_tuned_row(std::to_string(one.scans), one.noise, table);
  add_tuned_row("all", result.noise, table);
  return table;
}

std::string tuning_table_note() { return prose("tuning", "table"); }
std::string landscape_note() { return prose("tuning", "landscape"); }

TextTable landscape_table(const NoiseGrid& grid) {
  TextTable table;
  const double least = grid.least();
  for (std::size_t i = 0; i < grid.motion.size(); ++i) {
    std::vector<TextTable::Entry> row = {{"motion", readable(grid.motion[i], kFactorDigits)}};
    for (std::size_t j = 0; j < grid.sensor.size(); ++j) {
      const double above = grid.score[i][j] - least;
      row.push_back({readable(grid.sensor[j], kFactorDigits),
                     std::isfinite(above) ? compact(above) : "failed"});
    }
    table.add(row);
  }
  return table;
}

Frame landscape_frame(const NoiseGrid& grid) {
  Frame frame;
  for (const char* name : {"motion_factor", "sensor_factor", "score"})
    frame.columns.push_back({.name = name});
  for (std::size_t i = 0; i < grid.motion.size(); ++i) {
    for (std::size_t j = 0; j < grid.sensor.size(); ++j)
      frame.push({grid.motion[i], grid.sensor[j], grid.score[i][j]});
  }
  return frame;
}

Figure landscape_figure(const TuningResult& result) {
  const NoiseGrid& grid = result.grid;
  Figure figure = figure_of("noise_landscape");
  figure.name = "landscape";
  figure.chart.x_label = "factor on the noise of the motion, as a power of 2";
  Panel panel{"landscape", "score above the least", {}, {}};
  const double least = grid.least();
  std::vector<double> places;
  for (const double motion : grid.motion) places.push_back(std::log2(motion));
  for (std::size_t j = 0; j < grid.sensor.size(); ++j) {
    Curve curve{"sensor x " + readable(grid.sensor[j], kFactorDigits), j, {}};
    for (const auto& row : grid.score) {
      const double above = row[j] - least;
      curve.values.push_back(above <= kHighestDrawn ? above : kNaN);
    }
    const bool is_drawn =
        std::ranges::any_of(curve.values, [](double value) { return std::isfinite(value); });
    if (is_drawn) panel.curves.push_back(std::move(curve));
  }
  add_panels({panel}, places, figure);
  figure.chart.x_from = places.front();
  return figure;
}

}  // namespace montecarta::analysis
