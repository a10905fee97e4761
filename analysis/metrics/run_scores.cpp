// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/run_scores.hpp"

#include "analysis/statistics/finite_mean.hpp"

#include <cmath>

namespace montecarta {
namespace {

template <class Values>
double sum_of(const Values& values) {
  double sum = 0.0;
  for (const auto value : values) sum += static_cast<double>(value);
  return sum;
}

template <class Values>
double mean_of(const Values& values) {
  return sum_of(values) / static_cast<double>(values.size());
}

double mean_of_roots(const std::vector<double>& squares) {
  double sum = 0.0;
  for (const double square : squares) sum += std::sqrt(square);
  return sum / static_cast<double>(squares.size());
}

void score_errors(const RunMetrics& metrics, RunScores& scores) {
  if (metrics.squared_position().empty()) return;  // nobody knows the truth
  scores.position_mse = mean_of(metrics.squared_position());
  scores.position_rmse = std::sqrt(scores.position_mse);
  scores.position_mean = mean_of_roots(metrics.squared_position());
  scores.position_variance = scores.position_mse - scores.position_mean * scores.position_mean;
  scores.heading_mse = mean_of(metrics.squared_heading());
  scores.heading_rmse = std::sqrt(scores.heading_mse);
  scores.heading_mean = mean_of_roots(metrics.squared_heading());
}

void score_diversity(const Diversity& diversity, RunScores& scores) {
  scores.last_resampling = mean_of(diversity.last_resampling);
  scores.lag = mean_of(diversity.lag);
  scores.root = mean_of(diversity.root);
  scores.final_root = diversity.root.back();
}

void score_association(const AssociationRows& rows, RunScores& scores) {
  scores.correct = sum_of(rows.correct);
  scores.wrong = sum_of(rows.wrong);
  scores.new_again = sum_of(rows.new_again);
  scores.missed = sum_of(rows.missed);
  scores.clutter = sum_of(rows.clutter);
}

void score_map(const RunRows& rows, RunScores& scores) {
  if (!rows.map_size.empty()) {
    scores.map_landmarks = rows.map_size.back();
  } else if (rows.final_map) {
    scores.map_landmarks = static_cast<double>(rows.final_map->places().size());
  }
}

constexpr ScoreName kNames[] = {
    {"position_rmse", "m", "position RMSE", &RunScores::position_rmse},
    {"position_mse", "m2", "position MSE", &RunScores::position_mse},
    {"position_error", "m", "mean position error", &RunScores::position_mean},
    {"position_error_variance_over_time", "m2", "variance of the position error over time",
     &RunScores::position_variance},
    {"heading_rmse", "rad", "heading RMSE", &RunScores::heading_rmse},
    {"heading_mse", "rad2", "heading MSE", &RunScores::heading_mse},
    {"heading_error", "rad", "mean absolute heading error", &RunScores::heading_mean},
    {"nees", "1", "mean NEES of the pose", &RunScores::nees, Better::neither},
    {"nees_position", "1", "mean NEES of the position", &RunScores::nees_position, Better::neither},
    {"nees_distance", "1", "NEES distance from consistency [doublings]", &RunScores::nees_distance},
    {"ess", "1", "effective particles", &RunScores::ess, Better::higher},
    {"resampling_rate", "1", "share of scans that resample", &RunScores::resampling_rate,
     Better::neither},
    {"ancestors_last_resampling", "1", "distinct particles after a resampling",
     &RunScores::last_resampling, Better::higher},
    {"ancestors_10_s_ago", "1", "distinct ancestors 10 s ago", &RunScores::lag, Better::higher},
    {"ancestors_at_start", "1", "distinct ancestors at the start", &RunScores::root,
     Better::higher},
    {"ancestors_at_start_at_the_end", "1", "first particles that have descendants at the end",
     &RunScores::final_root, Better::higher},
    {"coalescence", "s", "time back to the common ancestor", &RunScores::coalescence,
     Better::higher},
    {"monte_carlo_variance", "m2", "position variance by few particles",
     &RunScores::monte_carlo_variance},
    {"association_correct", "1", "detections rightly associated", &RunScores::correct,
     Better::higher},
    {"association_wrong", "1", "detections given to a wrong landmark", &RunScores::wrong},
    {"association_new_again", "1", "detections made new again", &RunScores::new_again},
    {"association_missed", "1", "detections left out", &RunScores::missed},
    {"association_clutter", "1", "false alarms accepted", &RunScores::clutter},
    {"reference_rms", "m", "RMS distance to the reference", &RunScores::reference_rms},
    {"reference_median", "m", "median distance to the reference", &RunScores::reference_median},
    {"reference_gated_rms", "m", "RMS distance to the reference without outliers",
     &RunScores::reference_gated_rms},
    {"reference_aligned_rms", "m", "RMS distance to the reference, aligned",
     &RunScores::reference_aligned_rms},
    {"reference_aligned_median", "m", "median distance to the reference, aligned",
     &RunScores::reference_aligned_median},
    {"reference_aligned_gated_rms", "m", "RMS distance to the reference without outliers, aligned",
     &RunScores::reference_aligned_gated_rms},
    {"reference_heading_rmse", "rad", "heading RMSE to the reference",
     &RunScores::reference_heading_rmse},
    {"map_landmarks", "1", "landmarks in the final map", &RunScores::map_landmarks,
     Better::neither},
    {"beacons_found", "1", "surveyed beacons found", &RunScores::beacons_found, Better::higher},
    {"beacon_rms", "m", "RMS error of the beacons found", &RunScores::beacon_rms},
    {"beacon_aligned_rms", "m", "RMS error of the beacons found, aligned",
     &RunScores::beacon_aligned_rms},
    {"landmark_rms", "m", "RMS error of the landmarks in the final map", &RunScores::landmark_rms},
    {"landmark_nees", "1", "NEES of a landmark in the final map, mean over landmarks",
     &RunScores::landmark_nees},
    {"joint_nees", "1", "joint NEES of pose and map per component", &RunScores::joint_nees,
     Better::neither},
    {"gospa", "m", "GOSPA of the final map", &RunScores::gospa},
    {"gospa_localisation", "m", "localisation part of GOSPA", &RunScores::gospa_localisation},
    {"landmarks_missed", "1", "landmarks missed by the final map", &RunScores::landmarks_missed},
    {"landmarks_invented", "1", "landmarks invented by the final map",
     &RunScores::landmarks_invented},
    {"numerical_faults", "1", "factorisations answered by a fallback",
     &RunScores::numerical_faults},
    {"cpu_seconds", "s", "processor time of a run", &RunScores::cpu_seconds},
};

}  // namespace

RunScores scores_of(const RunRows& rows, const RunMetrics& metrics) {
  RunScores scores;
  score_errors(metrics, scores);
  if (const NeesRows* nees = metrics.leading_nees()) {
    scores.nees = mean_of_finite(nees->value[0]);
    scores.nees_position = mean_of_finite(nees->value[1]);
    scores.nees_distance = nees_distance(scores.nees, 3);
  }
  if (!rows.ess.empty()) {
    scores.ess = mean_of(rows.ess);
    scores.resampling_rate = mean_of(rows.resampled);
  }
  if (metrics.diversity() != nullptr) score_diversity(*metrics.diversity(), scores);
  if (const Lineages* lineages = metrics.lineages()) {
    scores.coalescence = lineages->coalescence;
    scores.monte_carlo_variance = lineages->monte_carlo_variance;
  }
  if (!rows.association.correct.empty()) score_association(rows.association, scores);
  score_map(rows, scores);
  scores.numerical_faults = sum_of(rows.numerical_faults);
  scores.cpu_seconds = rows.cpu_seconds;
  return scores;
}

double nees_distance(double nees, std::size_t dimension) {
  return std::abs(std::log2(nees / static_cast<double>(dimension)));
}

std::span<const ScoreName> score_names() { return kNames; }

}  // namespace montecarta
