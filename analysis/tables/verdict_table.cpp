// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/tables/verdict_table.hpp"

#include "analysis/metrics/nees.hpp"
#include "analysis/tables/number_text.hpp"
#include "engine/numbers/angle.hpp"

#include <algorithm>

namespace montecarta {
namespace {

constexpr double kDegrees = 180.0 / kPi;

std::string interval_text(const Interval& interval) {
  std::string text(1, '[');
  return text.append(readable(interval.lower) + ", " + readable(interval.upper) + "]");
}

/// The band of all complete runs: single scans may have fewer valid ones.
std::string band_text(const CellAnalysis& cell, std::size_t dimension, double level) {
  if (cell.complete == 0) return "-";
  return interval_text(nees_bounds(cell.complete, dimension, level));
}

std::string exit_text(const Consistency& consistency) {
  if (consistency.verdict == Verdict::untested) return "-";
  return consistency.lasting_exit ? readable(*consistency.lasting_exit) + " s" : "never";
}

std::string in_degrees(const Summary& radians) {
  return with_error(kDegrees * radians.mean, kDegrees * radians.standard_error());
}

std::vector<std::string> verdict_row(const CellAnalysis& cell, double level) {
  const Consistency verdict = cell.consistency();
  const bool tested = verdict.verdict != Verdict::untested;
  const auto if_tested = [&](const std::string& text) { return tested ? text : "-"; };
  return {cell.label,
          runs_in_words(cell),
          in_words(verdict),
          if_tested(compact(verdict.mean)),
          if_tested(band_text(cell, 3, level)),
          if_tested(percent(verdict.share_inside)),
          if_tested(percent(verdict.share_above)),
          if_tested(percent(verdict.share_below)),
          exit_text(verdict)};
}

std::vector<std::string> accuracy_row(const CellAnalysis& cell) {
  return {cell.label,
          with_error(cell.error.position_rmse.mean, cell.error.position_rmse.standard_error()),
          in_degrees(cell.error.heading_rmse),
          percent(cell.efficiency.position),
          cell.weights ? readable(cell.weights->ess.mean) : "-",
          cell.diversity ? readable(cell.diversity->final_root.mean) : "-",
          readable(cell.cpu_seconds.mean)};
}

std::vector<std::string> association_row(const CellAnalysis& cell) {
  const AssociationSummary& a = *cell.association;
  const double all = a.correct.mean + a.wrong.mean + a.new_again.mean + a.missed.mean;
  return {cell.label,
          readable(all, 4),
          percent(a.correct.mean / all),
          percent(a.wrong.mean / all),
          percent(a.new_again.mean / all),
          percent(a.missed.mean / all),
          readable(a.clutter.mean)};
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
          compact(found.median),
          readable(ideal_nees(cell, nees)),
          band_text(cell, nees.series.dimension, level),
          percent(found.share_inside),
          percent(found.share_above),
          percent(found.share_below),
          std::to_string(nees.series.floored),
          std::to_string(nees.series.undefined)};
}

}  // namespace

std::string name_of(ErrorBlock block) {
  return block == ErrorBlock::pose       ? "pose"
         : block == ErrorBlock::position ? "position"
                                         : "heading";
}

std::string name_of(Moments moments) { return moments == Moments::mixture ? "mixture" : "spread"; }

std::string runs_in_words(const CellAnalysis& cell) {
  std::string words;
  if (!cell.failures.empty()) words += std::to_string(cell.failures.size()) + " FAILED, ";
  if (cell.missing > 0) words += std::to_string(cell.missing) + " missing, ";
  return words + std::to_string(cell.complete) + " complete";
}

TextTable verdict_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},
                    {"runs", Align::left},
                    {"verdict", Align::left},
                    {"ANEES"},
                    {level_text(study.level) + " band"},
                    {"inside"},
                    {"above"},
                    {"below"},
                    {"leaves at"}};
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
  for (const CellAnalysis& cell : study.cells) table.rows.push_back(accuracy_row(cell));
  return table;
}

TextTable association_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left}, {"detections"}, {"correct"},       {"wrong"},
                    {"new again"},         {"left out"},   {"false accepted"}};
  for (const CellAnalysis& cell : study.cells) {
    if (cell.association) table.rows.push_back(association_row(cell));
  }
  return table;
}

std::vector<std::string> association_notes() {
  return {
      "Detections of landmarks in a run, counted against the identities that come with them, as "
      "the "
      "filter's weighted particles took them: 'correct' went to their own landmark or were "
      "rightly made new, 'wrong' to another one, 'new again' were made new although the map had "
      "theirs, 'left out' were not used; 'false accepted' are false alarms in a run that were "
      "used."};
}

TextTable consistency_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},
                    {"error", Align::left},
                    {"covariance", Align::left},
                    {"verdict", Align::left},
                    {"ANEES"},
                    {"median"},
                    {"ideal"},
                    {level_text(study.level) + " band"},
                    {"inside"},
                    {"above"},
                    {"below"},
                    {"floored"},
                    {"undefined"}};
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

std::vector<std::string> verdict_notes(const StudyAnalysis& study) {
  const std::string level = level_text(study.level);
  const std::string rest = level_text(1.0 - study.level);
  return {
      "ANEES compares the errors that happened with the errors the filter expected (its "
      "covariance), averaged over runs: 3 means it knows how wrong it is (three components: x, "
      "y, heading), more means it is too sure of itself, less that it is too cautious.",
      "The band is where chance alone keeps a right filter in " + level +
          " of scans; it holds for each scan by itself (pointwise), so about " + rest +
          " of scans outside are expected and neighbouring scans go together.",
      "'inconsistent from t' means " + std::to_string(kLastingScans) +
          " scans in a row above the band, the first at t; 'never' means not within the " +
          readable(study.duration, 4) +
          " s of this study. 'optimistic' and 'conservative' mean outside more than twice as "
          "often as chance has it, mostly above or mostly below.",
      "RMSE is given as mean over runs +- its standard error; ESS is the effective number of "
      "particles, roots how many of the first particles still have descendants at the end, CPU "
      "the filter's own time in a run; all of complete runs only."};
}

}  // namespace montecarta
