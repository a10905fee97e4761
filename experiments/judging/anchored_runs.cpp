// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/anchored_runs.hpp"

#include "analysis/statistics/symmetric_eigen.hpp"
#include "engine/formatted.hpp"
#include "engine/text/number_text.hpp"
#include "experiments/judging/difference_bound.hpp"

#include <cmath>

namespace montecarta::experiments {
namespace {

/// Largest share of a variance that the anchor's error may have where it does not count.
constexpr double kSmallShare = 1e-3;
/// Largest share of the estimates of a run that may be left out soon after its anchor.
constexpr double kMostLeftOut = 0.1;

/// Whether the part of the anchor's error is small in each direction of an estimate's error: the
/// largest eigenvalue of L^-1 B L^-T with P = L L', in the range of P.
bool is_small(Eigen::MatrixXd part, const Eigen::MatrixXd& covariance) {
  constexpr double kLeastVariance = 1e-12;  // [m^2, rad^2]
  constexpr double kLeastEigenvalue = 1e-12;
  std::vector<Eigen::Index> open;
  for (Eigen::Index i = 0; i < part.rows(); ++i) {
    if (part(i, i) <= kLeastVariance) {
      part.row(i).setZero();
      part.col(i).setZero();
    }
    if (part(i, i) > kSmallShare * covariance(i, i)) return false;
    if (covariance(i, i) > 0.0) open.push_back(i);
  }
  if (part.isZero(0.0)) return true;
  const Eigen::MatrixXd P = covariance(open, open);
  const Eigen::VectorXd scale = P.diagonal().cwiseSqrt().cwiseInverse();
  const analysis::SymmetricEigen axes =
      analysis::symmetric_eigen(scale.asDiagonal() * P * scale.asDiagonal());
  const Eigen::VectorXd per_deviation = axes.values.unaryExpr(
      [](double v) { return v > kLeastEigenvalue ? 1.0 / std::sqrt(v) : 0.0; });
  const Eigen::MatrixXd whitening =
      per_deviation.asDiagonal() * axes.vectors.transpose() * scale.asDiagonal();
  const Eigen::MatrixXd whitened = whitening * part(open, open) * whitening.transpose();
  return analysis::symmetric_eigenvalues(whitened).maxCoeff() <= kSmallShare;
}

}  // namespace

void AnchoredRuns::survey(std::size_t cell, const StateRows& estimates,
                          const std::filesystem::path& path,
                          std::vector<std::optional<TrueState>> truths) {
  const auto row = move_to_anchor(anchor_, estimates, path, truths);
  if (!row) return;
  AnchoredCell& own = cells_[cell];
  const AnchorError error(anchor_, convention_, estimates, *row);
  for (const Eigen::Index i : moved_components(anchor_, estimates.shape)) {
    const double deviation = std::sqrt(std::abs(estimates.covariance[*row](i, i)));
    if (!(deviation > own.deviation)) continue;
    own.deviation = deviation;
    const auto k = static_cast<std::size_t>(i);
    own.of_deviation = formatted("{} {} of {} in {}", to_text(deviation), estimates.shape.units[k],
                                 estimates.shape.components[k], path);
  }
  if (error.is_known()) return;
  double rows = 0.0, near = 0.0;  // with a truth; of these, where the anchor's error is not small
  for (std::size_t k = 0; k < truths.size(); ++k) {
    if (!truths[k]) continue;
    rows += 1.0;
    const Eigen::MatrixXd& P = estimates.covariance[k];
    if (is_covariance(P) && !is_small(error.covariance_in(k), P)) near += 1.0;
  }
  if (near > kMostLeftOut * rows) own.is_bounded = true;
}

std::vector<bool> AnchoredRuns::are_bounded() const {
  std::vector<bool> found;
  for (const AnchoredCell& cell : cells_) found.push_back(cell.is_bounded);
  return found;
}

void AnchoredRuns::move(std::size_t cell, StateRows& estimates, const std::filesystem::path& path,
                        std::vector<std::optional<TrueState>>& truths) {
  const auto row = move_to_anchor(anchor_, estimates, path, truths);
  if (!row) return;
  const StateRows given = estimates;
  const AnchorError error(anchor_, convention_, given, *row);
  if (error.is_known()) return;
  for (std::size_t k = 0; k < truths.size(); ++k) {
    if (!truths[k] || !is_covariance(given.covariance[k])) continue;
    const Eigen::MatrixXd part = error.covariance_in(k);
    if (cells_[cell].is_bounded) {
      estimates.covariance[k] = largest_covariance_of_difference(given.covariance[k], part);
    } else if (!is_small(part, given.covariance[k])) {
      truths[k].reset();
      ++cells_[cell].removed;
    }
  }
}

std::vector<std::string> AnchoredRuns::notes(const std::vector<std::string>& labels) const {
  std::vector<std::string> notes;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const AnchoredCell& cell = cells_[c];
    if (cell.is_bounded) {
      notes.push_back(formatted(
          "{}: first estimates, onto which --anchor moves the truths, are not known well beside "
          "the later ones (deviations up to {}): the moved errors are judged by an upper bound",
          labels[c], cell.of_deviation));
    } else if (cell.removed > 0) {
      notes.push_back(
          formatted("{}: {} {} left out soon after the anchor, where its covariance is more than a "
                    "thousandth of theirs in a direction",
                    labels[c], cell.removed, cell.removed == 1 ? "estimate is" : "estimates are"));
    }
  }
  return notes;
}

}  // namespace montecarta::experiments
