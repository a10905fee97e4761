// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/reference_analysis.hpp"
#include "analysis/metrics/reference_report.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/means.hpp"
#include "engine/numbers/angle.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

/// No fix is known better than to a centimetre, no heading than to a hundredth of a degree.
std::string mean_text(const Spread& spread, double factor = 1.0) {
  return with_error_to(2, factor * spread.summary.mean, factor * spread.summary.standard_error());
}

std::string count_text(const Spread& spread) {
  return with_error_to(1, spread.summary.mean, spread.summary.standard_error());
}

/// The middle run and the two ends: "1.55 [1.41, 2.20]".
std::string runs_text(const Spread& spread) {
  if (std::isnan(spread.median)) return "-";
  const auto text = [](double value) { return with_error_to(2, value, kNaN); };
  return text(spread.median) + " [" + text(spread.least) + ", " + text(spread.greatest) + "]";
}

std::string of_text(std::size_t k, std::size_t n) {
  return std::to_string(k) + " of " + std::to_string(n);
}

/// Runs that can be judged: failed ones are lost and beat nothing.
std::size_t judged_runs(const CellAnalysis& cell, const ReferenceAnalysis& against) {
  return against.with_fixes() + cell.failures.size();
}

std::string lost_text(const CellAnalysis& cell, const ReferenceAnalysis& against) {
  return of_text(against.lost() + cell.failures.size(), judged_runs(cell, against));
}

bool any_heading(const StudyAnalysis& study) {
  return std::ranges::any_of(study.references, &JudgedReference::has_heading);
}

std::vector<std::string> reference_row(const StudyAnalysis& study, const CellAnalysis& cell,
                                       std::size_t r) {
  const ReferenceAnalysis& against = cell.get<ReferenceAnalyses>()[r];
  const auto text = [&](double ReferenceScores::*score) {
    return mean_text(against.over_runs(score));
  };
  const double kept = against.over_runs(&ReferenceScores::aligned_gated_share).summary.mean;
  std::vector<std::string> row = {
      cell.label,
      study.references[r].name,
      runs_in_words(cell),
      study.references[r].fixes == 0 ? "-" : lost_text(cell, against),
      text(&ReferenceScores::rms),
      text(&ReferenceScores::median),
      text(&ReferenceScores::aligned_rms),
      runs_text(against.over_runs(&ReferenceScores::aligned_rms)),
      text(&ReferenceScores::aligned_median),
      text(&ReferenceScores::aligned_gated_rms) + " (" + percent(kept) + ")"};
  if (any_heading(study)) {
    row.push_back(mean_text(against.over_runs(&ReferenceScores::heading_rmse), 180.0 / kPi));
  }
  return row;
}

std::vector<std::string> map_row(const StudyAnalysis& study, const CellAnalysis& cell) {
  const auto text = [&](std::string_view score) { return mean_text(cell.known_over_runs(score)); };
  const Spread found = cell.known_over_runs("beacons_found");
  std::vector<std::string> row = {cell.label, count_text(cell.known_over_runs("map_landmarks"))};
  if (study.beacons > 0) {
    row.push_back(
        found.summary.n == 0 ? "-" : count_text(found) + " of " + std::to_string(study.beacons));
    row.push_back(text("beacon_rms"));
    row.push_back(text("beacon_aligned_rms"));
  }
  row.push_back(readable(cell.over_runs("ess").mean));
  row.push_back(readable(cell.over_runs("ancestors_at_start_at_the_end").mean));
  row.push_back(readable(cell.over_runs("cpu_seconds").mean));
  return row;
}

std::string against_baseline(std::size_t better, std::size_t runs) {
  if (runs == 0) return "not tested";
  if (better == runs) return "better in every run";
  if (better == 0) return "better in no run";
  return 2 * better == runs  ? "better in half of the runs"
         : 2 * better > runs ? "better in most runs"
                             : "worse in most runs";
}

std::vector<std::string> baseline_row(const CellAnalysis& cell, const CellAnalysis* baseline,
                                      const JudgedReference& reference) {
  const ReferenceAnalysis& leading = cell.get<ReferenceAnalyses>().front();
  std::vector<std::string> row = {cell.label, lost_text(cell, leading)};
  if (baseline == nullptr) return row;
  if (&cell == baseline) {
    row.insert(row.end(), {"-", "is the baseline"});
    return row;
  }
  const auto score =
      reference.compares_raw() ? &ReferenceScores::rms : &ReferenceScores::aligned_rms;
  const double mean = baseline->get<ReferenceAnalyses>().front().over_runs(score).summary.mean;
  const std::size_t better = leading.better_than(mean, score), runs = judged_runs(cell, leading);
  row.insert(row.end(), {of_text(better, runs), against_baseline(better, runs)});
  return row;
}

}  // namespace

const CellAnalysis* baseline_of(const StudyAnalysis& study) {
  const auto found = std::ranges::find_if(study.cells, [](const CellAnalysis& cell) {
    return cell.filter == "ekf_slam" && cell.complete > 0 && !cell.get<ReferenceAnalyses>().empty();
  });
  return found == study.cells.end() ? nullptr : &*found;
}

TextTable reference_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},  {"reference", Align::left},
                    {"runs", Align::left},  {"lost"},
                    {"raw RMS [m]"},        {"raw median [m]"},
                    {"aligned RMS [m]"},    {"middle run [ends]"},
                    {"aligned median [m]"}, {"gated [m] (kept)"}};
  if (any_heading(study)) table.headings.push_back({"heading RMSE [deg]"});
  for (const CellAnalysis& cell : study.cells) {
    for (std::size_t r = 0; r < cell.get<ReferenceAnalyses>().size(); ++r) {
      table.rows.push_back(reference_row(study, cell, r));
    }
  }
  return table;
}

TextTable map_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left}, {"landmarks"}};
  if (study.beacons > 0) {
    table.headings.insert(table.headings.end(),
                          {{"beacons found"}, {"beacon error [m]"}, {"beacon error, aligned [m]"}});
  }
  table.headings.insert(table.headings.end(), {{"ESS"}, {"roots"}, {"CPU [s]"}});
  for (const CellAnalysis& cell : study.cells) table.rows.push_back(map_row(study, cell));
  return table;
}

TextTable baseline_table(const StudyAnalysis& study) {
  TextTable table;
  if (study.references.empty() || study.references.front().fixes == 0) return table;
  const CellAnalysis* baseline = baseline_of(study);
  table.headings = {{"cell", Align::left}, {"loses the map"}};
  if (baseline != nullptr) {
    table.headings.push_back({"beats " + baseline->label});
    table.headings.push_back({"against EKF-SLAM", Align::left});
  }
  for (const CellAnalysis& cell : study.cells) {
    table.rows.push_back(baseline_row(cell, baseline, study.references.front()));
  }
  return table;
}

}  // namespace montecarta::analysis
