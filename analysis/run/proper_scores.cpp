// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/proper_scores.hpp"

#include "engine/numbers/real.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

/// The last scan of each of at most kMostEnergyScans equal parts of a run.
std::vector<std::size_t> energy_scans(std::size_t scans) {
  const std::size_t count = std::min(scans, kMostEnergyScans);
  std::vector<std::size_t> chosen(count);
  for (std::size_t k = 0; k < count; ++k) chosen[k] = (k + 1) * scans / count - 1;
  return chosen;
}

double mean_energy_score(const RunRows& rows, std::size_t particles) {
  if (rows.truth.empty() || rows.particle_pose.empty() || rows.log_weight.empty()) return kNaN;
  std::vector<double> values;
  for (const std::size_t s : energy_scans(rows.truth.size() / 3)) {
    values.push_back(
        energy_score(std::span(rows.particle_pose).subspan(3 * particles * s, 3 * particles),
                     std::span(rows.log_weight).subspan(particles * s, particles),
                     Eigen::Vector2d(rows.truth[3 * s], rows.truth[3 * s + 1])));
  }
  return mean_of_finite(values);
}

}  // namespace

double log_score(std::span<const WhitenedPose> errors) {
  std::vector<double> values;
  for (const WhitenedPose& error : errors) values.push_back(negative_log_density(error));
  return mean_of_finite(values);
}

double energy_score(std::span<const double> pose, std::span<const double> log_weight,
                    const Eigen::Vector2d& truth) {
  double sum = 0.0, distance = 0.0, pairs = 0.0;
  std::vector<double> weight(log_weight.size());
  for (std::size_t i = 0; i < weight.size(); ++i) {
    weight[i] = std::exp(log_weight[i]);
    const double x = pose[3 * i], y = pose[3 * i + 1];
    double to_others = 0.0;
    for (std::size_t j = 0; j < i; ++j)
      to_others += weight[j] * length(pose[3 * j] - x, pose[3 * j + 1] - y);
    sum += weight[i];
    distance += weight[i] * length(truth.x() - x, truth.y() - y);
    pairs += weight[i] * to_others;  // each pair counts once, which gives half of the expectation
  }
  return distance / sum - pairs / (sum * sum);
}

ProperScores proper_scores(const RunRows& rows, std::size_t particles,
                           std::span<const WhitenedPose> errors) {
  return {log_score(errors), mean_energy_score(rows, particles)};
}

}  // namespace montecarta::analysis
