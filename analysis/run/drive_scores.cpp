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

/// Covariance of the pose at a row, as the filter reports it.
struct RowBelief {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double inverse_freedom = 0.0;  ///< 1 / degrees of freedom of the covariance; 0 if it is exact
  bool is_known = true;
};

/// Means and covariances of the pose at all rows.
struct RowBeliefs {
  std::vector<double> mean;  ///< {row, 3} [m, m, rad] means of the pose
  std::vector<RowBelief> beliefs;
};

/// Returns the expected covariance of the mean's error for drawn poses, with Satterthwaite's
/// degrees of freedom (STATISTICS 4).
RowBelief belief_of_draws(const Eigen::Matrix3d& spread, const EffectiveDraws& draws,
                          std::size_t dimension) {
  RowBelief belief;
  belief.is_known = draws.of_mean > static_cast<double>(dimension) + 2.0;
  if (!belief.is_known) return belief;
  belief.covariance = spread * (draws.of_mean + 1.0) / (draws.of_mean - 1.0);
  belief.inverse_freedom = 1.0 / (draws.of_variance - 1.0);
  return belief;
}

/// {row} The number of draws that the weighted particles are worth: that of the last scan, since
/// weights do not change between scans, and all particles before the first one.
std::vector<EffectiveDraws> draws_of_rows(const RunRows& rows, std::size_t particles,
                                          std::span<const std::uint32_t> scan_rows) {
  const std::size_t n = rows.path.mean().size() / 3;
  std::vector<EffectiveDraws> draws;
  if (particles == 0) return draws;
  std::size_t scans = 0;  // number of scans up to the row
  for (std::size_t row = 0; row < n; ++row) {
    while (scan_rows.empty() ? scans <= row : scans < scan_rows.size() && scan_rows[scans] <= row) {
      ++scans;
    }
    draws.push_back(scans == 0 ? effective_draws(particles, static_cast<double>(particles))
                               : draws_at(rows, particles, scans - 1));
  }
  return draws;
}

RowBeliefs beliefs_of(const RunRows& rows, std::size_t particles,
                      std::span<const std::uint32_t> scan_rows, std::size_t dimension) {
  const MomentRows &spread = rows.path.spread, &mixture = rows.path.mixture;
  const std::vector<EffectiveDraws> draws = draws_of_rows(rows, particles, scan_rows);
  RowBeliefs all;
  for (std::size_t row = 0; row < rows.path.mean().size() / 3; ++row) {
    const bool by_draws =
        particles > 0 && !spread.covariance.empty() && is_drawn(spread, mixture, row);
    const MomentRows& moments = !by_draws && !mixture.covariance.empty() ? mixture : spread;
    const Eigen::Matrix3d covariance =
        Eigen::Map<const BeliefMatrix>(moments.covariance.data() + 9 * row);
    const auto mean = std::span(moments.mean).subspan(3 * row, 3);
    all.mean.insert(all.mean.end(), mean.begin(), mean.end());
    all.beliefs.push_back(by_draws ? belief_of_draws(covariance, draws[row], dimension)
                                   : RowBelief{covariance});
  }
  return all;
}

/// Interpolates the belief at a place; at the start it is the one that filters are given.
RowBelief belief_between(const std::vector<RowBelief>& rows, const Eigen::Matrix3d& at_start,
                         const PathAtFixes::FixPlace& place) {
  const RowBelief& after = rows[place.next];
  const RowBelief before =
      place.next == 0 ? RowBelief{at_start, after.inverse_freedom} : rows[place.next - 1];
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

/// An error in units of P + R, and the logarithm of the determinant of P + R.
struct WhitenedAtFix {
  Eigen::VectorXd error;
  double log_determinant;
};

/// The error in units of P + R; nullopt if P + R is not positive definite.
std::optional<WhitenedAtFix> in_units_of(const Eigen::VectorXd& error, const RowBelief& belief,
                                         const Eigen::MatrixXd& own,
                                         const Eigen::MatrixXd& of_fix) {
  const Eigen::MatrixXd total = own + of_fix;
  const Eigen::LLT<Eigen::MatrixXd> factor(total);
  if (!belief.is_known || !total.allFinite() || !error.allFinite() ||
      factor.info() != Eigen::Success) {
    return std::nullopt;
  }
  const Eigen::VectorXd whitened = factor.matrixL().solve(error);
  const double log_determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  const double nees = whitened.squaredNorm();
  if (nees == 0.0) return WhitenedAtFix{whitened, log_determinant};
  const double scaled = on_chi_square_scale(nees, total, own, belief.inverse_freedom);
  return WhitenedAtFix{whitened * std::sqrt(scaled / nees), log_determinant};
}

bool is_stored(const RunRows& rows) {
  return !rows.path.spread.covariance.empty() || !rows.path.mixture.covariance.empty();
}

}  // namespace

FixErrors errors_at_fixes(const PathAtFixes& fixes, std::span<const std::uint32_t> scan_rows,
                          const RunRows& rows, std::size_t particles, ErrorBlock block) {
  FixErrors result;
  const bool needs_heading = block != ErrorBlock::position;
  if (!is_stored(rows) || (needs_heading && fixes.headings().empty())) return result;
  const std::size_t dimension = dimension_of(block);
  const Eigen::Index first = block == ErrorBlock::heading ? 2 : 0;
  const auto d = static_cast<Eigen::Index>(dimension);
  const RowBeliefs path = beliefs_of(rows, particles, scan_rows, dimension);
  const std::vector<Pose> poses = fixes.interpolate(path.mean);
  for (std::size_t f = 0; f < poses.size(); ++f) {
    const double heading = fixes.headings().empty() ? poses[f].heading : fixes.headings()[f];
    const Eigen::Vector2d& position = fixes.positions()[f];
    const Eigen::Vector3d error = boxminus(poses[f], {position.x(), position.y(), heading});
    const RowBelief belief =
        belief_between(path.beliefs, fixes.start_covariance(), fixes.places()[f]);
    const Eigen::MatrixXd of_fix = fixes.covariances()[f].block(first, first, d, d);
    const auto whitened = in_units_of(error.segment(first, d), belief,
                                      belief.covariance.block(first, first, d, d), of_fix);
    if (!whitened) {
      ++result.undefined;
      continue;
    }
    add_whitened(whitened->error, result.whitened);
    add_whitened(of_fix.llt().matrixL().solve(error.segment(first, d)), result.by_reference);
    result.nees.push_back(whitened->error.squaredNorm());
    result.log_determinant.push_back(whitened->log_determinant);
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

void count_outliers(const FixErrors& errors, DriveScores& scores) {
  const double most = kGrossDeviations * kGrossDeviations * scores.median;
  double sum = 0.0;
  for (const double nees : errors.nees) {
    if (nees > most) {
      ++scores.outliers;
    } else {
      sum += nees;
    }
  }
  const auto n = static_cast<double>(errors.nees.size() - scores.outliers);
  scores.ratio_without_outliers = sum / n / static_cast<double>(dimension_of(scores.leading));
}

void judge_leading(const FixErrors& errors, double level, DriveScores& scores) {
  scores.fixes = errors.nees.size();
  scores.undefined = errors.undefined;
  if (scores.fixes < kFewestFixes) return;
  scores.median = median_of(errors.nees) / median_of_chi_square(dimension_of(scores.leading));
  count_outliers(errors, scores);
  scores.seconds = errors.times.back() - errors.times.front();
  scores.is_the_reference = farthest_square(errors.by_reference) < kSameWithin * kSameWithin;
  scores.is_below_reference = correlated_average(errors.by_reference, level).ratio.upper < 1.0;
}

}  // namespace

DriveScores drive_scores(const PathAtFixes& fixes, std::span<const std::uint32_t> scan_rows,
                         const RunRows& rows, std::size_t particles, double level) {
  DriveScores scores;
  scores.in_gaps = fixes.in_gaps();
  scores.leading = fixes.headings().empty() ? ErrorBlock::position : ErrorBlock::pose;
  for (const ErrorBlock block : kErrorBlocks) {
    FixErrors errors = errors_at_fixes(fixes, scan_rows, rows, particles, block);
    if (block == scores.leading) judge_leading(errors, level, scores);
    if (errors.nees.size() < kFewestFixes) continue;
    scores.blocks[static_cast<std::size_t>(block)] = correlated_average(errors.whitened, level);
    scores.errors[static_cast<std::size_t>(block)] = std::move(errors.whitened);
  }
  return scores;
}

}  // namespace montecarta::analysis
