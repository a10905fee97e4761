// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/reference_analysis.hpp"

#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/statistics/means.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
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

std::size_t ReferenceAnalysis::better_than(double baseline, double ReferenceScores::*score) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      runs, [&](const ReferenceScores& run) { return run.*score < baseline; }));
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

}  // namespace montecarta::analysis
