// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/statistics/means.hpp"

#include <cmath>

namespace montecarta {
namespace {

double mean_of_roots(const std::vector<double>& squares) {
  if (squares.empty()) return kNaN;
  double sum = 0.0;
  for (const double square : squares) sum += std::sqrt(square);
  return sum / static_cast<double>(squares.size());
}

double position_mse(const MeasuredRun& run) { return mean_of(run.metrics.squared_position()); }
double position_mean(const MeasuredRun& run) {
  return mean_of_roots(run.metrics.squared_position());
}
double heading_mse(const MeasuredRun& run) { return mean_of(run.metrics.squared_heading()); }

}  // namespace

std::span<const Score> scores_of_errors() {
  static constexpr Score kAll[] = {
      {"position_rmse", "m", "position RMSE",
       [](const MeasuredRun& run) { return std::sqrt(position_mse(run)); }},
      {"position_mse", "m2", "position MSE", position_mse},
      {"position_error", "m", "mean position error", position_mean},
      {"position_error_variance_over_time", "m2", "variance of the position error over time",
       [](const MeasuredRun& run) {
         const double mean = position_mean(run);
         return position_mse(run) - mean * mean;
       }},
      {"heading_rmse", "rad", "heading RMSE",
       [](const MeasuredRun& run) { return std::sqrt(heading_mse(run)); }},
      {"heading_mse", "rad2", "heading MSE", heading_mse},
      {"heading_error", "rad", "mean absolute heading error",
       [](const MeasuredRun& run) { return mean_of_roots(run.metrics.squared_heading()); }},
  };
  return kAll;
}
std::span<const ScanSeries> series_of_errors() {
  static constexpr ScanSeries kAll[] = {
      {"position_rmse", "m", [](const MeasuredRun& run) { return run.metrics.squared_position(); },
       true},
      {"heading_rmse", "rad", [](const MeasuredRun& run) { return run.metrics.squared_heading(); },
       true},
  };
  return kAll;
}

}  // namespace montecarta
