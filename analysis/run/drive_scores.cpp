// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/drive_scores.hpp"

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/sampler_scale.hpp"
#include "engine/core/pose.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace montecarta::analysis {
namespace {

double median_of_chi_square(std::size_t dimension) {
  return chi_squared_quantile(0.5, static_cast<double>(dimension));
}

using BeliefMatrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Covariance of the pose after a scan, as the filter reports it.
struct ScanBelief {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double inverse_freedom = 0.0;  ///< 1 / degrees of freedom of the covariance; 0 if it is exact
  bool is_known = true;
};

/// Means and covariances of the pose after all scans.
struct ScanBeliefs {
  std::vector<double> mean;  ///< {scan, 3} [m, m, rad] means of the pose
  std::vector<ScanBelief> beliefs;
};

/// Returns the expected covariance of the mean's error for drawn poses, with Satterthwaite's
/// degrees of freedom (STATISTICS 4).
ScanBelief belief_of_draws(const Eigen::Matrix3d& spread, const EffectiveDraws& draws,
                           std::size_t dimension) {
  ScanBelief belief;
  belief.is_known = draws.of_mean > static_cast<double>(dimension) + 2.0;
  if (!belief.is_known) return belief;
  belief.covariance = spread * (draws.of_mean + 1.0) / (draws.of_mean - 1.0);
  belief.inverse_freedom = 1.0 / (draws.of_variance - 1.0);
  return belief;
}

ScanBeliefs beliefs_of(const RunRows& rows, std::size_t particles, std::size_t scans,
                       std::size_t dimension) {
  ScanBeliefs all;
  const bool has_mixture = !rows.mixture.covariance.empty();
  for (std::size_t s = 0; s < scans; ++s) {
    const bool by_draws = particles > 0 && !rows.spread.covariance.empty() && is_drawn(rows, s);
    const MomentRows& moments = !by_draws && has_mixture ? rows.mixture : rows.spread;
    const Eigen::Matrix3d covariance =
        Eigen::Map<const BeliefMatrix>(moments.covariance.data() + 9 * s);
    const auto mean = std::span(moments.mean).subspan(3 * s, 3);
    all.mean.insert(all.mean.end(), mean.begin(), mean.end());
    all.beliefs.push_back(by_draws
                              ? belief_of_draws(covariance, draws_at(rows, particles, s), dimension)
                              : ScanBelief{covariance});
  }
  return all;
}

/// Interpolates the belief at a place; the pose at the start is known exactly.
ScanBelief belief_between(const std::vector<ScanBelief>& scans,
                          const PathAtFixes::FixPlace& place) {
  const ScanBelief& after = scans[place.next];
  const ScanBelief before = place.next == 0 ? ScanBelief{.inverse_freedom = after.inverse_freedom}
                                            : scans[place.next - 1];
  return {(1.0 - place.share) * before.covariance + place.share * after.covariance,
          std::lerp(before.inverse_freedom, after.inverse_freedom, place.share),
          before.is_known && after.is_known};
}

/// Converts the NEES by `total` = P + R to the scale of the chi-square, with the degrees of freedom
/// of the sum of an estimated and an exact covariance (K. Krishnamoorthy, J. Yu 2004).
double on_chi_square_scale(double nees, const Eigen::MatrixXd& total, const Eigen::MatrixXd& own,
                           double inverse_freedom) {
  if (inverse_freedom == 0.0) return nees;
  const auto d = static_cast<double>(total.rows());
  const Eigen::MatrixXd share = total.llt().solve(own);
  const double of_one = (share * share).trace() + share.trace() * share.trace();
  const double freedom = (d + d * d) / (inverse_freedom * of_one);
  // A number of draws that stands for infinity, because `own` is already the covariance of the
  // mean's error.
  constexpr double kExactMean = 1e300;
  return sampler_scale(static_cast<std::size_t>(total.rows()))(nees, {kExactMean, freedom + 1.0});
}

void add_whitened(const Eigen::VectorXd& error, VectorSeries& series) {
  series.resize(static_cast<std::size_t>(error.size()));
  for (Eigen::Index c = 0; c < error.size(); ++c) {
    series[static_cast<std::size_t>(c)].push_back(error(c));
  }
}

/// The error in units of P + R; nullopt if P + R is not positive definite.
std::optional<Eigen::VectorXd> in_units_of(const Eigen::VectorXd& error, const ScanBelief& belief,
                                           const Eigen::MatrixXd& own,
                                           const Eigen::MatrixXd& of_fix) {
  const Eigen::MatrixXd total = own + of_fix;
  const Eigen::LLT<Eigen::MatrixXd> factor(total);
  if (!belief.is_known || !total.allFinite() || !error.allFinite() ||
      factor.info() != Eigen::Success) {
    return std::nullopt;
  }
  const Eigen::VectorXd whitened = factor.matrixL().solve(error);
  const double nees = whitened.squaredNorm();
  if (nees == 0.0) return whitened;
  const double scaled = on_chi_square_scale(nees, total, own, belief.inverse_freedom);
  return whitened * std::sqrt(scaled / nees);
}

bool is_stored(const RunRows& rows) {
  return !rows.spread.covariance.empty() || !rows.mixture.covariance.empty();
}

}  // namespace

FixErrors errors_at_fixes(const PathAtFixes& fixes, std::span<const double> scan_times,
                          const RunRows& rows, std::size_t particles, ErrorBlock block) {
  FixErrors result;
  const bool needs_heading = block != ErrorBlock::position;
  if (!is_stored(rows) || (needs_heading && fixes.headings().empty())) return result;
  const std::size_t dimension = dimension_of(block);
  const Eigen::Index first = block == ErrorBlock::heading ? 2 : 0;
  const auto d = static_cast<Eigen::Index>(dimension);
  const ScanBeliefs scans = beliefs_of(rows, particles, scan_times.size(), dimension);
  const std::vector<Pose> poses = fixes.interpolate(scans.mean);
  for (std::size_t f = 0; f < poses.size(); ++f) {
    const PathAtFixes::FixPlace& place = fixes.places()[f];
    const double before = place.next == 0 ? 0.0 : scan_times[place.next - 1];
    if (scan_times[place.next] - before > kLongestScanGap) {
      ++result.in_gaps;
      continue;
    }
    const double heading = fixes.headings().empty() ? poses[f].heading : fixes.headings()[f];
    const Eigen::Vector2d& position = fixes.positions()[f];
    const Eigen::Vector3d error = boxminus(poses[f], {position.x(), position.y(), heading});
    const ScanBelief belief = belief_between(scans.beliefs, place);
    const Eigen::MatrixXd of_fix = fixes.covariances()[f].block(first, first, d, d);
    const auto whitened = in_units_of(error.segment(first, d), belief,
                                      belief.covariance.block(first, first, d, d), of_fix);
    if (!whitened) {
      ++result.undefined;
      continue;
    }
    add_whitened(*whitened, result.whitened);
    add_whitened(of_fix.llt().matrixL().solve(error.segment(first, d)), result.by_reference);
    result.nees.push_back(whitened->squaredNorm());
    result.times.push_back(fixes.times()[f]);
  }
  return result;
}

namespace {

constexpr std::size_t kFewestFixes = 2;

// Largest length [standard deviations of a fix] of an error that counts as zero.
constexpr double kSameWithin = 1e-3;

/// Returns the largest squared length of the samples of `series` {component}{sample}.
double farthest_square(const VectorSeries& series) {
  double farthest = 0.0;
  for (std::size_t t = 0; t < series.front().size(); ++t) {
    double square = 0.0;
    for (const auto& component : series) square += component[t] * component[t];
    farthest = std::max(farthest, square);
  }
  return farthest;
}

void judge_leading(const FixErrors& errors, double level, DriveScores& scores) {
  scores.fixes = errors.nees.size();
  scores.in_gaps = errors.in_gaps;
  scores.undefined = errors.undefined;
  if (scores.fixes < kFewestFixes) return;
  scores.median = median_of(errors.nees) / median_of_chi_square(dimension_of(scores.leading));
  scores.seconds = errors.times.back() - errors.times.front();
  scores.is_the_reference = farthest_square(errors.by_reference) < kSameWithin * kSameWithin;
  scores.is_below_reference = correlated_average(errors.by_reference, level).ratio.upper < 1.0;
}

}  // namespace

DriveScores drive_scores(const PathAtFixes& fixes, std::span<const double> scan_times,
                         const RunRows& rows, std::size_t particles, double level) {
  DriveScores scores;
  scores.leading = fixes.headings().empty() ? ErrorBlock::position : ErrorBlock::pose;
  for (const ErrorBlock block : kErrorBlocks) {
    FixErrors errors = errors_at_fixes(fixes, scan_times, rows, particles, block);
    if (block == scores.leading) judge_leading(errors, level, scores);
    if (errors.nees.size() < kFewestFixes) continue;
    scores.blocks[static_cast<std::size_t>(block)] = correlated_average(errors.whitened, level);
    scores.errors[static_cast<std::size_t>(block)] = std::move(errors.whitened);
  }
  return scores;
}

}  // namespace montecarta::analysis
