// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/reference_analysis.hpp"

#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/statistics/means.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta {
namespace {

/// By the leading reference.
template <double ReferenceScores::*kValue>
double of_reference(const MeasuredRun& run) {
  return run.references.empty() ? kNaN : run.references.front().scores.*kValue;
}

}  // namespace

std::span<const Score> scores_of_references() {
  static constexpr Score kAll[] = {
      {"reference_rms", "m", "RMS distance to the reference", of_reference<&ReferenceScores::rms>},
      {"reference_median", "m", "median distance to the reference",
       of_reference<&ReferenceScores::median>},
      {"reference_gated_rms", "m", "RMS distance to the reference without outliers",
       of_reference<&ReferenceScores::gated_rms>},
      {"reference_aligned_rms", "m", "RMS distance to the reference, aligned",
       of_reference<&ReferenceScores::aligned_rms>},
      {"reference_aligned_median", "m", "median distance to the reference, aligned",
       of_reference<&ReferenceScores::aligned_median>},
      {"reference_aligned_gated_rms", "m",
       "RMS distance to the reference without outliers, aligned",
       of_reference<&ReferenceScores::aligned_gated_rms>},
      {"reference_heading_rmse", "rad", "heading RMSE to the reference",
       of_reference<&ReferenceScores::heading_rmse>},
  };
  return kAll;
}

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

}  // namespace montecarta
