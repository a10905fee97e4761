// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/pits.hpp"

#include "analysis/run/nees.hpp"
#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/sampler_scale.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

double wrapped(std::size_t component, double difference) {
  return component == 2 ? wrap(difference) : difference;
}

/// Gaussian probability of a value below `deviation` = truth - mean; NaN without a positive
/// variance.
double gaussian_share(double deviation, double variance) {
  if (!(variance > 0.0) || !std::isfinite(variance) || !std::isfinite(deviation)) return kNaN;
  return 0.5 * std::erfc(-deviation / std::sqrt(2.0 * variance));
}

RunPits::Components gaussian_pits(const std::vector<double>& truth, const MomentRows& moments,
                                  std::size_t scan) {
  RunPits::Components pits;
  for (std::size_t c = 0; c < 3; ++c) {
    const double deviation = wrapped(c, truth[3 * scan + c] - moments.mean[3 * scan + c]);
    pits[c] = gaussian_share(deviation, moments.covariance[9 * scan + 4 * c]);
  }
  return pits;
}

/// Transforms by the law of the truth as one more draw (Hotelling's F of one component). NaN for
/// three effective draws or fewer.
RunPits::Components drawn_pits(const RunRows& rows, const EffectiveDraws& draws, std::size_t scan) {
  RunPits::Components pits{kNaN, kNaN, kNaN};
  const double E = draws.of_mean;
  if (!(E > 3.0)) return pits;
  for (std::size_t c = 0; c < 3; ++c) {
    const double error = wrapped(c, rows.truth[3 * scan + c] - rows.spread.mean[3 * scan + c]);
    const double variance = rows.spread.covariance[9 * scan + 4 * c] * (E + 1.0) / (E - 1.0);
    if (!(variance > 0.0) || !std::isfinite(variance) || !std::isfinite(error)) continue;
    pits[c] = t_cdf(error / std::sqrt(variance), draws.of_variance - 1.0);
  }
  return pits;
}

/// Particles of one scan as seen from the truth, whose own error is zero.
struct Cloud {
  std::vector<double> weight;          ///< {particle}
  std::vector<Eigen::Vector3d> error;  ///< {particle} pose minus truth
};

/// Every `step`-th particle from `first` on.
Cloud cloud_at(const RunRows& rows, std::size_t scan, std::size_t first, std::size_t step) {
  const std::size_t M = rows.log_weight.size() / (rows.truth.size() / 3);
  Cloud cloud;
  for (std::size_t i = scan * M + first; i < (scan + 1) * M; i += step) {
    cloud.weight.push_back(std::exp(rows.log_weight[i]));
    Eigen::Vector3d& error = cloud.error.emplace_back();
    for (std::size_t c = 0; c < 3; ++c)
      error(static_cast<Eigen::Index>(c)) =
          wrapped(c, rows.particle_pose[3 * i + c] - rows.truth[3 * scan + c]);
  }
  return cloud;
}

/// Draws of equal weight out of weighted ones: a particle stays with the probability of its weight
/// over the largest (rejection by the supremum of the sample; Caffo, Booth and Davis, Biometrika
/// 89, 2002). Exact if weights do not depend on poses.
std::vector<Eigen::Vector3d> equal_draws(const Cloud& cloud, RngStream& draw) {
  std::vector<Eigen::Vector3d> kept;
  double largest = 0.0;
  for (const double weight : cloud.weight) largest = std::max(largest, weight);
  for (std::size_t i = 0; i < cloud.weight.size(); ++i) {
    if (draw.uniform() * largest < cloud.weight[i]) kept.push_back(cloud.error[i]);
  }
  return kept;
}

/// Rank of the truth among draws of equal weight; NaN without any. N draws leave N + 1 gaps of
/// equal probability, and `within` spreads the truth evenly over its gap from run to run.
template <class Below>
double rank_among(const std::vector<Eigen::Vector3d>& draws, double within, const Below& below) {
  if (draws.empty()) return kNaN;
  const auto found = static_cast<double>(std::ranges::count_if(draws, below));
  return (found + within) / static_cast<double>(draws.size() + 1);
}

RunPits::Components rank_pits(const std::vector<Eigen::Vector3d>& draws, double within) {
  RunPits::Components pits;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto row = static_cast<Eigen::Index>(c);
    pits[c] =
        rank_among(draws, within, [&](const Eigen::Vector3d& error) { return error(row) < 0.0; });
  }
  return pits;
}

/// Rank of the squared distance of the truth among those of `draws`, from the mean and by the
/// covariance of `others`, which so is no function of what is ranked. NaN for three effective
/// particles or fewer, or if their covariance is singular.
double rank_of_distance(const Cloud& others, const std::vector<Eigen::Vector3d>& draws,
                        double within) {
  double all = 0.0, squares = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < others.weight.size(); ++i) {
    all += others.weight[i];
    squares += others.weight[i] * others.weight[i];
    mean += others.weight[i] * others.error[i];
  }
  if (!(all * all > 3.0 * squares)) return kNaN;
  mean /= all;
  Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < others.weight.size(); ++i) {
    const Eigen::Vector3d off = others.error[i] - mean;
    P += others.weight[i] * off * off.transpose();
  }
  const Eigen::LLT<Eigen::Matrix3d> L(P);
  if (L.info() != Eigen::Success) return kNaN;
  const auto distance = [&](const Eigen::Vector3d& error) {
    return L.matrixL().solve(error - mean).squaredNorm();
  };
  const double of_truth = distance(Eigen::Vector3d::Zero());
  return rank_among(draws, within,
                    [&](const Eigen::Vector3d& error) { return distance(error) < of_truth; });
}

/// A number in (0, 1) that is evenly spread over any stretch of runs: multiples of the golden
/// ratio.
double evenly(std::uint64_t run) {
  const double golden = 0.6180339887498949 * (static_cast<double>(run) + 0.5);
  return golden - std::floor(golden);
}

/// Ranks at the end of a quarter, whose last scan this is.
void add_ranks(const RunRows& rows, std::size_t quarter, std::size_t scan, std::uint64_t run,
               RunPits& pits) {
  RngStream draw({.seed = 0,
                  .run = run,
                  .step = static_cast<std::uint32_t>(quarter),
                  .purpose = Draw::analysis_thinning});
  const double within = evenly(run);
  pits.rank[quarter] = rank_pits(equal_draws(cloud_at(rows, scan, 0, 1), draw), within);
  pits.rank_nees[quarter] = rank_of_distance(cloud_at(rows, scan, 0, 2),
                                             equal_draws(cloud_at(rows, scan, 1, 2), draw), within);
}

/// Transforms of one landmark of the map, a different one from run to run.
std::array<double, 2> landmark_pits(const FinalMap& map, std::uint64_t run,
                                    std::span<const Eigen::Vector2d> landmarks) {
  std::vector<std::size_t> seen;
  for (std::size_t l = 0; l < std::min(map.seen.size(), landmarks.size()); ++l) {
    if (map.seen[l] != 0) seen.push_back(l);
  }
  if (seen.empty()) return {kNaN, kNaN};
  const std::size_t l = seen[run % seen.size()];
  const Eigen::Vector2d error = landmarks[l] - map.mean[l];
  return {gaussian_share(error.x(), map.covariance[l](0, 0)),
          gaussian_share(error.y(), map.covariance[l](1, 1))};
}

}  // namespace

RunPits pits_of(const RunRows& rows, std::size_t particles, std::uint64_t run,
                std::span<const Eigen::Vector2d> landmarks) {
  RunPits pits;
  if (rows.truth.empty()) return pits;
  const MomentRows& estimate = estimate_of(rows);
  const auto scans = calibration_scans(rows.truth.size() / 3);
  pits.has_pose = !estimate.covariance.empty();
  pits.has_rank = !rows.log_weight.empty();
  pits.has_landmark = rows.final_map && !landmarks.empty();
  for (std::size_t m = 0; m < kQuarters; ++m) {
    if (pits.has_pose) {
      const bool drawn = particles > 0 && is_drawn(rows, scans[m]);
      pits.pose[m] = drawn ? drawn_pits(rows, draws_at(rows, particles, scans[m]), scans[m])
                           : gaussian_pits(rows.truth, estimate, scans[m]);
    }
    if (!pits.has_rank) continue;
    pits.rank[m].fill(kNaN);
    pits.rank_nees[m] = kNaN;
    // Where no poses were drawn, each particle has a Gaussian of its own.
    if (is_drawn(rows, scans[m])) add_ranks(rows, m, scans[m], run, pits);
  }
  if (pits.has_landmark) pits.landmark = landmark_pits(*rows.final_map, run, landmarks);
  return pits;
}

std::array<double, kQuarters> nees_pits(std::span<const double> nees, std::size_t dimension) {
  std::array<double, kQuarters> pits;
  const auto scans = calibration_scans(nees.size());
  for (std::size_t m = 0; m < kQuarters; ++m) {
    const double value = nees[scans[m]];
    pits[m] = std::isfinite(value) ? chi_squared_cdf(value, static_cast<double>(dimension)) : kNaN;
  }
  return pits;
}

}  // namespace montecarta::analysis
