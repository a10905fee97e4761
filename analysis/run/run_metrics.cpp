// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/run_metrics.hpp"

#include "analysis/run/imported_errors.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/core/pose.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

DrawsScales scales_of(const EffectiveDraws& draws) {
  DrawsScales scales{draws.of_mean, {}};
  for (std::size_t d = 1; d <= scales.of.size(); ++d) {
    if (sampler_scale(d).can_judge(draws)) scales.of[d - 1] = sampler_scale(d).line(draws);
  }
  return scales;
}

Pose pose_of(const std::vector<double>& rows, std::size_t s) {
  return {rows[3 * s], rows[3 * s + 1], rows[3 * s + 2]};
}

void measure_nees(const std::vector<double>& truth, const MomentRows& moments, NeesRows& rows) {
  const std::size_t scans = truth.empty() ? 0 : moments.covariance.size() / 9;
  rows.resize(scans);
  for (std::size_t s = 0; s < scans; ++s) {
    const Eigen::Vector3d error = boxminus(pose_of(moments.mean, s), pose_of(truth, s));
    const Eigen::Matrix3d P = Eigen::Map<const RowMajor3>(moments.covariance.data() + 9 * s);
    const auto found = pose_nees(error, P);
    for (std::size_t b = 0; b < found.size(); ++b) rows.set(b, s, found[b]);
  }
}

/// NEES of imported errors: of all components, and for a pose in the plane also of its parts.
void measure_imported(const ErrorRows& errors, bool is_pose, NeesRows& rows) {
  const std::size_t d = errors.components();
  const std::size_t scans = errors.scans();
  rows.dimension = is_pose ? std::array<std::size_t, 3>{3, 2, 1} : std::array<std::size_t, 3>{d};
  rows.resize(is_pose ? scans : 0);
  rows.value[0].resize(scans);
  rows.rank[0].resize(scans);
  for (std::size_t s = 0; s < scans; ++s) {
    const Eigen::VectorXd e = errors.error(s);
    const Eigen::MatrixXd P = errors.covariance_of(s);
    const bool is_missing = e.array().isNaN().all() && P.array().isNaN().all();
    const Nees whole = is_missing ? Nees{kNaN, Nees::kMissing} : imported_nees(e, P);
    rows.set(0, s, whole);
    if (!is_pose) continue;
    rows.set(1, s, whole.is_usable() ? imported_nees(e.head(2), P.topLeftCorner(2, 2)) : whole);
    rows.set(2, s, whole.is_usable() ? imported_nees(e.tail(1), P.bottomRightCorner(1, 1)) : whole);
  }
}

/// The forward direction of a vehicle with this estimate. If the estimate is the mean of `draws`
/// draws (infinite if it is exact), the direction is that of the mean of draws and truth, which
/// does not depend on the error (STATISTICS 5).
Direction<double> ahead_in(ErrorFrame frame, const Pose& mean, const Pose& truth,
                           double draws = std::numeric_limits<double>::infinity()) {
  if (frame == ErrorFrame::of_truth) return direction_of(truth.heading);
  return direction_of(mean.heading - wrap(mean.heading - truth.heading) / (draws + 1.0));
}

/// Turns x and y of `error`, and of the covariance of scan `s` if there is one, to forward and left
/// of a vehicle that heads `ahead`; `P` becomes the turned covariance. All is done in place, since
/// copies of numbers that were just written would wait for memory.
void turn_pose(const Direction<double>& ahead, const std::vector<double>& covariances,
               std::size_t s, Eigen::Vector3d& error, Eigen::Matrix3d& P) {
  const Eigen::Matrix2d turn{{ahead.cosine, ahead.sine}, {-ahead.sine, ahead.cosine}};
  error.head<2>() = turn * error.head<2>();
  if (covariances.empty()) return;
  P = Eigen::Map<const RowMajor3>(covariances.data() + 9 * s);
  P.topRows<2>() = turn * P.topRows<2>();
  P.leftCols<2>() = P.leftCols<2>() * turn.transpose();
}

/// Puts errors of drawn poses on the scale of the normal law: the squares of all components
/// together, and each component by itself, become the values of equal probability (STATISTICS 4).
void put_on_normal_scale(const DrawsScales& scales, WhitenedPose& pose) {
  double squares = 0.0;
  for (const double u : pose.whitened) squares += std::isnan(u) ? 0.0 : u * u;
  if (pose.rank > 0 && squares > 0.0)
    pose.whitened *= std::sqrt((*scales.of[pose.rank - 1])(squares) / squares);
  for (double& z : pose.standardised) z = std::copysign(std::sqrt((*scales.of[0])(z * z)), z);
}

void put_on_full_scale(NeesRows& rows) {
  for (std::size_t b = 0; b < rows.value.size(); ++b) {
    for (std::size_t s = 0; s < rows.value[b].size(); ++s) {
      double& value = rows.value[b][s];
      const int rank = rows.rank[b][s];
      if (std::isnan(value) || static_cast<std::size_t>(rank) == rows.dimension[b]) continue;
      value = on_full_scale({value, rank}, rows.dimension[b]);
    }
  }
}

}  // namespace

void RunMetrics::measure_errors(const RunRows& rows, std::size_t scans, ErrorFrame frame) {
  const auto& [mean, covariance] = estimate_of(rows);
  if (rows.truth.empty() || mean.empty()) scans = 0;
  expect(scans == 0 || (rows.truth.size() == 3 * scans && mean.size() == 3 * scans),
         "poses are {scan, 3}");
  squared_position_.resize(scans);
  squared_heading_.resize(scans);
  errors_.resize(scans);
  covariances_.resize(covariance.empty() ? 0 : scans);
  estimates_.resize(covariances_.size());
  Eigen::Matrix3d none;
  for (std::size_t s = 0; s < scans; ++s) {
    const Pose estimate = pose_of(mean, s), truth = pose_of(rows.truth, s);
    Eigen::Vector3d& error = errors_[s];
    error = boxminus(estimate, truth);
    squared_position_[s] = error(0) * error(0) + error(1) * error(1);
    squared_heading_[s] = error(2) * error(2);
    turn_pose(ahead_in(frame, estimate, truth), covariance, s, error,
              covariance.empty() ? none : covariances_[s]);
    if (!covariance.empty()) analysis::whiten_pose(error, covariances_[s], estimates_[s]);
  }
}

const NeesRows* RunMetrics::leading_nees() const {
  const auto found =
      std::ranges::find_if(nees_, [](const NeesRows& rows) { return !rows.value[0].empty(); });
  return found == nees_.end() ? nullptr : &*found;
}

/// Corrects the spread for the number of draws. At a scan that drew no poses, the covariance
/// includes each particle's own and is judged as it is, if the filter has a mixture (STATISTICS 4).
void RunMetrics::correct_spread(std::size_t s, const std::optional<DrawsScales>& scales) {
  NeesRows& corrected = nees_[static_cast<std::size_t>(Moments::corrected)];
  const NeesRows& mixture = nees(Moments::mixture);
  for (std::size_t b = 0; b < kErrorBlocks.size(); ++b) {
    double& value = corrected.value[b][s];
    const auto rank = static_cast<std::size_t>(std::max(corrected.rank[b][s], 0));
    if (!scales) {
      corrected.set(b, s, {mixture.value[b][s], mixture.rank[b][s]});
    } else if (!scales->of[dimension_of(kErrorBlocks[b]) - 1]) {
      corrected.too_few[b][s] = 1;
      value = kNaN;
    } else if (rank > 0) {
      value = (*scales->of[rank - 1])(value);
    }
  }
}

/// Whitens the pose of scan `s` by the moments that lead at this scan.
void RunMetrics::whiten_pose(const RunRows& rows, std::size_t s,
                             const std::optional<DrawsScales>& scales, ErrorFrame frame) {
  const MomentRows& moments =
      scales || rows.mixture.covariance.empty() ? rows.spread : rows.mixture;
  WhitenedPose pose;
  if (!scales && &moments == &estimate_of(rows)) {
    pose = estimates_[s];
    add_errors_of_exact(errors_[s], covariances_[s], least_pose_deviation(),
                        whitened_.errors_of_exact);
  } else {
    const double draws = scales ? scales->draws : std::numeric_limits<double>::infinity();
    const Pose mean = pose_of(moments.mean, s), truth = pose_of(rows.truth, s);
    Eigen::Vector3d error = boxminus(mean, truth);
    Eigen::Matrix3d P;
    turn_pose(ahead_in(frame, mean, truth, draws), moments.covariance, s, error, P);
    analysis::whiten_pose(error, P, pose);
    add_errors_of_exact(error, P, least_pose_deviation(), whitened_.errors_of_exact);
  }
  if (scales) put_on_normal_scale(*scales, pose);
  Eigen::Vector3d::Map(whitened_.whitened.data() + 3 * s) = pose.whitened;
  Eigen::Vector3d::Map(whitened_.standardised.data() + 3 * s) = pose.standardised;
}

void RunMetrics::correct_and_whiten(const RunRows& rows, std::size_t particles, ErrorFrame frame) {
  NeesRows& corrected = nees_[static_cast<std::size_t>(Moments::corrected)];
  corrected = particles > 0 ? nees(Moments::spread) : NeesRows{};
  for (std::size_t b = 0; b < kErrorBlocks.size(); ++b)
    corrected.too_few[b].assign(corrected.value[b].size(), 0);
  const NeesRows* leading = leading_nees();
  whitened_.dimension = leading == nullptr ? 0 : leading->dimension[0];
  const std::size_t d = whitened_.dimension, scans = d == 0 ? 0 : leading->value[0].size();
  whitened_.whitened.assign(scans * d, kNaN);
  whitened_.standardised.assign(scans * d, kNaN);
  whitened_.errors_of_exact.assign(d, 0.0);
  whitened_.number = rows.run;
  for (std::size_t s = 0; s < scans; ++s) {
    std::optional<DrawsScales> scales;
    if (leading == &corrected) {
      if (is_drawn(rows, s)) scales = scales_of(draws_at(rows, particles, s));
      correct_spread(s, scales);
    }
    // True if the filter claims to know all components exactly. The spread of drawn poses makes no
    // such claim.
    const bool is_known = leading->rank[0][s] == 0 && leading != &corrected;
    if (std::isnan(leading->value[0][s]) && !is_known) continue;
    if (rows.error.components() == 0) {
      whiten_pose(rows, s, scales, frame);
      continue;
    }
    whiten_imported(rows.error.error(s), rows.error.covariance_of(s), rows.error.rounding(), s,
                    whitened_);
  }
}

void RunMetrics::measure(const RunRows& rows, std::size_t particles, std::span<const double> times,
                         ErrorFrame frame) {
  measure_errors(rows, times.size(), frame);
  NeesRows& spread = nees_[static_cast<std::size_t>(Moments::spread)];
  if (rows.error.components() > 0) {
    measure_imported(rows.error, !rows.spread.mean.empty(), spread);
  } else {
    measure_nees(rows.truth, rows.spread, spread);
  }
  measure_nees(rows.truth, rows.mixture, nees_[static_cast<std::size_t>(Moments::mixture)]);
  correct_and_whiten(rows, particles, frame);
  for (NeesRows& all : nees_) put_on_full_scale(all);
  diversity_ = nullptr;
  lineages_.reset();
  if (rows.ancestor.empty()) return;
  diversity_ = &counter_.count(rows.ancestor, particles, times);
  lineages_ = walker_.walk(rows, counter_.resampled(), times, squared_position_);
}

}  // namespace montecarta::analysis
