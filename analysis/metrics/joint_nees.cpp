// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/joint_nees.hpp"

#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/statistics/means.hpp"
#include "engine/numbers/angle.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// e' P^-1 e by Cholesky of the correlation matrix, whose pivots do not depend on units.
double quadratic_form(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  if (!error.allFinite() || !covariance.allFinite() || !scale.allFinite()) return kNaN;
  const Eigen::LLT<Eigen::MatrixXd> L(scale.asDiagonal() * covariance * scale.asDiagonal());
  if (L.info() != Eigen::Success) return kNaN;
  return L.matrixL().solve(scale.cwiseProduct(error)).squaredNorm();
}

/// Of the pose and of each landmark: where the truth is known and the map has one.
Eigen::VectorXd error_of(std::span<const double> mean, std::span<const double> pose,
                         std::span<const Eigen::Vector2d> landmarks,
                         std::vector<Eigen::Index>& rows) {
  Eigen::VectorXd error(static_cast<Eigen::Index>(mean.size()));
  rows = {0, 1, 2};
  error.head<3>() << mean[0] - pose[0], mean[1] - pose[1], wrap(mean[2] - pose[2]);
  for (std::size_t l = 0; l < landmarks.size() && 4 + 2 * l < mean.size(); ++l) {
    const auto row = static_cast<Eigen::Index>(3 + 2 * l);
    const bool in_map = !std::isnan(mean[3 + 2 * l]);
    error.segment<2>(row) = Eigen::Vector2d(mean[3 + 2 * l], mean[4 + 2 * l]) - landmarks[l];
    if (in_map) rows.insert(rows.end(), {row, row + 1});
  }
  return error;
}

Interval bounds_per_component(double dimensions, double level) {
  const Interval sum = nees_bounds(1, static_cast<std::uint64_t>(dimensions), level);
  return {sum.lower / dimensions, sum.upper / dimensions};
}

/// Consistent where every row is shown to be within the margin, else rejected where one is shown to
/// be off; too large goes before too small.
void judge_rows(JointConsistency& found) {
  bool is_within = true;
  double highest = 1.0, lowest = 1.0;
  for (std::size_t k = 0; k < found.average.size(); ++k) {
    if (found.runs[k] == 0) continue;
    const Interval ratio = ratio_of_row(found, k);
    found.verdict = Verdict::undecided;
    is_within = is_within && ratio.upper <= found.within && ratio.lower * found.within >= 1.0;
    if (ratio.lower > highest) {
      highest = ratio.lower;
      found.highest_row = k;
    }
    if (ratio.upper < lowest) {
      lowest = ratio.upper;
      found.lowest_row = k;
    }
  }
  if (found.verdict == Verdict::untested) return;
  found.verdict = is_within           ? Verdict::consistent
                  : found.highest_row ? Verdict::optimistic
                  : found.lowest_row  ? Verdict::conservative
                                      : Verdict::undecided;
}

/// Runs after which the interval of no row is longer, in logarithms, than the margin, so that it
/// excludes 1 or is inside.
std::uint64_t more_runs_that_decide(const JointConsistency& found, double row_level) {
  std::uint64_t more = 1;
  for (std::size_t k = 0; k < found.average.size(); ++k) {
    const auto runs = static_cast<std::uint64_t>(found.runs[k]);
    if (runs == 0) continue;
    const auto decide = [&](std::uint64_t n) {
      const Interval bounds =
          bounds_per_component(static_cast<double>(n) * found.dimension[k], row_level);
      return bounds.upper <= found.within * bounds.lower;
    };
    std::uint64_t enough = runs, too_few = runs;
    while (!decide(enough)) enough *= 2;
    while (enough - too_few > 1) {
      const std::uint64_t middle = too_few + (enough - too_few) / 2;
      (decide(middle) ? enough : too_few) = middle;
    }
    more = std::max(more, enough - runs);
  }
  return more;
}

}  // namespace

Interval ratio_of_row(const JointConsistency& joint, std::size_t row) {
  return {joint.average[row] / joint.bounds[row].upper,
          joint.average[row] / joint.bounds[row].lower};
}

std::vector<JointScore> joint_scores(const JointRows& rows, std::span<const std::uint32_t> scans,
                                     std::span<const double> truth,
                                     std::span<const Eigen::Vector2d> landmarks) {
  std::vector<JointScore> scores;
  std::vector<Eigen::Index> known;
  const std::size_t states = rows.states();
  if (states == 0) return scores;
  for (std::size_t k = 0; k * states < rows.mean.size(); ++k) {
    const auto mean = std::span(rows.mean).subspan(k * states, states);
    const Eigen::VectorXd error =
        error_of(mean, truth.subspan(3 * std::size_t{scans[k]}, 3), landmarks, known);
    const auto size = static_cast<Eigen::Index>(states);
    const Eigen::Map<const RowMajor> P(rows.covariance.data() + k * states * states, size, size);
    scores.push_back({quadratic_form(error(known), P(known, known)), known.size()});
  }
  return scores;
}

double nees_per_component(std::span<const JointScore> scores) {
  double sum = 0.0, dimensions = 0.0;
  for (const JointScore& score : scores) {
    if (std::isnan(score.nees)) continue;
    sum += score.nees;
    dimensions += static_cast<double>(score.dimension);
  }
  return sum / dimensions;
}

void JointNeesSums::add(std::span<const JointScore> run) {
  if (run.empty()) return;
  ++n_runs_;
  rows_.resize(run.size());
  for (std::size_t k = 0; k < run.size(); ++k) {
    const auto dimension = static_cast<double>(run[k].dimension);
    rows_[k].all_dimensions += dimension;
    if (std::isnan(run[k].nees)) continue;
    rows_[k].nees += run[k].nees;
    rows_[k].dimensions += dimension;
    ++rows_[k].runs;
  }
}

/// The sum over runs is chi-square with the sum of the dimensions; each of K rows is tested at
/// 1 - (1 - level) / K, so that a consistent filter passes all with probability `level` at least.
JointConsistency JointNeesSums::result(double level, bool identities_known, double within) const {
  JointConsistency found;
  found.within = within;
  found.stored = n_runs_ > 0;
  if (!found.stored) return found;
  if (!identities_known) {
    found.missing = "nobody knows which landmark is which";
    return found;
  }
  const double row_level = 1.0 - (1.0 - level) / static_cast<double>(rows_.size());
  for (const Sums& row : rows_) {
    found.samples += n_runs_;
    found.undefined += n_runs_ - row.runs;
    found.runs.push_back(row.runs);
    found.dimension.push_back(row.all_dimensions / static_cast<double>(n_runs_));
    found.average.push_back(row.nees / row.dimensions);
    if (row.runs == 0) {
      found.bounds.push_back({kNaN, kNaN});
      continue;
    }
    found.bounds.push_back(bounds_per_component(row.dimensions, row_level));
  }
  judge_rows(found);
  if (found.verdict == Verdict::undecided) {
    found.more_runs = more_runs_that_decide(found, row_level);
  }
  return found;
}

}  // namespace montecarta::analysis
