// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/reference_sums.hpp"

#include "analysis/study/paired_runs.hpp"
#include "analysis/study/prose.hpp"
#include "analysis/study/score_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace montecarta::analysis {
namespace {

void add_spread(const std::string& name, const std::string& units, const Spread& spread,
                Frame::Row& all) {
  all.emplace_back(name + "_mean", units, spread.summary.mean);
  all.emplace_back(name + "_standard_error", units, spread.summary.standard_error());
  all.emplace_back(name + "_median", units, spread.median);
  all.emplace_back(name + "_least", units, spread.least);
  all.emplace_back(name + "_greatest", units, spread.greatest);
}

/// Returns whether a number belongs to the map: it is the same against every reference.
bool is_of_the_map(const std::string& name) {
  return name.starts_with("map_") || name.starts_with("beacon");
}

}  // namespace

Spread ReferenceAnalysis::over_runs(double ReferenceScores::*score) const {
  std::vector<double> values;
  for (const ReferenceScores& run : runs) {
    if (run.has_fixes()) values.push_back(run.*score);
  }
  return spread_of(values);
}

std::size_t ReferenceAnalysis::with_fixes() const {
  return static_cast<std::size_t>(std::ranges::count_if(runs, &ReferenceScores::has_fixes));
}

std::size_t ReferenceAnalysis::lost() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      runs, [](const ReferenceScores& run) { return run.has_fixes() && run.lost(); }));
}

void ReferenceAccumulator::add(const ReferenceRun& run) {
  runs_.push_back(run.scores);
  if (fixes_ == Fixes::own) return;
  squared_.resize(run.squared_error.size());
  for (std::size_t f = 0; f < squared_.size(); ++f) squared_[f] += run.squared_error[f];
}

ReferenceAnalysis ReferenceAccumulator::result() const {
  ReferenceAnalysis analysis{runs_, squared_};
  for (double& error : analysis.error_over_time) {
    error = std::sqrt(error / static_cast<double>(runs_.size()));
  }
  return analysis;
}

const CellAnalysis* baseline_of(const StudyAnalysis& study) {
  const auto found = std::ranges::find_if(study.cells, [](const CellAnalysis& cell) {
    return cell.filter == "ekf_slam" && cell.complete > 0 && !cell.get<ReferenceAnalyses>().empty();
  });
  return found == study.cells.end() ? nullptr : &*found;
}

namespace {

const ReferenceAnalysis& leading_of(const CellAnalysis& cell) {
  return cell.get<ReferenceAnalyses>().front();
}

/// The score of the run of this number; infinite if it failed.
double score_of_run(const CellAnalysis& cell, std::uint64_t run, double ReferenceScores::*score) {
  const auto found = std::ranges::lower_bound(cell.runs, run);
  if (found == cell.runs.end() || *found != run) return std::numeric_limits<double>::infinity();
  return leading_of(cell).runs[static_cast<std::size_t>(found - cell.runs.begin())].*score;
}

}  // namespace

RunsAgainst runs_against(const CellAnalysis& cell, const CellAnalysis& baseline,
                         double ReferenceScores::*score, DrivesOfRuns drives) {
  const double mean = leading_of(baseline).over_runs(score).summary.mean;
  RunsAgainst found;
  const std::vector<ReferenceScores>& runs = leading_of(cell).runs;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const double one = runs[i].*score;
    const double other =
        drives == DrivesOfRuns::own ? score_of_run(baseline, cell.runs[i], score) : mean;
    if (are_equal(one, other)) {
      ++found.equal;
    } else if (one < other) {
      ++found.better;
    }
  }
  return found;
}

std::string no_truth_sentence(const StudyAnalysis& study) {
  if (study.references.empty()) return prose("references", "no reference");
  const bool has_errors = std::ranges::any_of(study.references, &JudgedReference::has_errors);
  return prose("references", has_errors ? "known errors" : "no truth");
}

Frame::Row reference_numbers(const CellAnalysis& cell, std::size_t reference) {
  const ReferenceAnalysis& against = cell.get<ReferenceAnalyses>()[reference];
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  const bool judged = cell.complete == 0 || against.with_fixes() > 0;
  const std::size_t lost = against.lost() + cell.failures.size();
  Frame::Row all = {{"runs_failed", "1", count(cell.failures.size())},
                    {"runs_complete", "1", count(cell.complete)},
                    {"runs_lost", "1", judged ? count(lost) : kNaN}};
  const auto one = [&](const char* name, const char* units, double ReferenceScores::*score) {
    add_spread(name, units, against.over_runs(score), all);
  };
  one("rms", "m", &ReferenceScores::rms);
  one("median_error", "m", &ReferenceScores::median);
  one("gated_rms", "m", &ReferenceScores::gated_rms);
  one("gated_share", "1", &ReferenceScores::gated_share);
  one("aligned_rms", "m", &ReferenceScores::aligned_rms);
  one("aligned_median_error", "m", &ReferenceScores::aligned_median);
  one("aligned_gated_rms", "m", &ReferenceScores::aligned_gated_rms);
  one("aligned_gated_share", "1", &ReferenceScores::aligned_gated_share);
  one("heading_rmse", "rad", &ReferenceScores::heading_rmse);
  for (const Score& score : all_scores()) {
    if (!is_of_the_map(score.name)) continue;
    add_spread(score.name, score.units, cell.known_over_runs(score.name), all);
  }
  all.emplace_back("cpu_seconds_mean", "s", cell.over_runs("cpu_seconds").mean);
  return all;
}

}  // namespace montecarta::analysis
