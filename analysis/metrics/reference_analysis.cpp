// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/reference_analysis.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta {

Spread ReferenceAnalysis::over_runs(double ReferenceScores::*score) const {
  std::vector<double> values;
  for (const ReferenceScores& run : runs) values.push_back(run.*score);
  return spread_of(values);
}

std::size_t ReferenceAnalysis::lost() const {
  return static_cast<std::size_t>(std::ranges::count_if(runs, &ReferenceScores::lost));
}

std::size_t ReferenceAnalysis::better_than(double baseline) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      runs, [&](const ReferenceScores& run) { return run.aligned_rms < baseline; }));
}

void ReferenceAccumulator::add(const ReferenceRun& run) {
  runs_.push_back(run.scores);
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

void put_leading_scores(const ReferenceAnalysis& leading, std::span<RunScores> scores) {
  expect(leading.runs.size() == scores.size(), "every complete run has its reference scores");
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const ReferenceScores& run = leading.runs[i];
    scores[i].reference_rms = run.rms;
    scores[i].reference_median = run.median;
    scores[i].reference_gated_rms = run.gated_rms;
    scores[i].reference_aligned_rms = run.aligned_rms;
    scores[i].reference_aligned_median = run.aligned_median;
    scores[i].reference_aligned_gated_rms = run.aligned_gated_rms;
    scores[i].reference_heading_rmse = run.heading_rmse;
  }
}

}  // namespace montecarta
