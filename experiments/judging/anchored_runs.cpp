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
/// Largest share of the estimates that may be left out soon after their anchors.
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

void AnchoredRuns::survey(const StateRows& estimates, const std::filesystem::path& path,
                          std::vector<std::optional<TrueState>> truths) {
  const auto row = move_to_anchor(anchor_, estimates, path, truths);
  if (!row) return;
  const AnchorError error(anchor_, convention_, estimates, *row);
  for (const Eigen::Index i : moved_components(anchor_, estimates.shape)) {
    const double deviation = std::sqrt(std::abs(estimates.covariance[*row](i, i)));
    if (!(deviation > deviation_)) continue;
    deviation_ = deviation;
    const auto k = static_cast<std::size_t>(i);
    of_deviation_ = formatted("{} {} of {} in {}", to_text(deviation), estimates.shape.units[k],
                              estimates.shape.components[k], path);
  }
  for (std::size_t k = 0; k < truths.size(); ++k) {
    if (!truths[k]) continue;
    ++rows_;
    if (!error.is_known() && is_covariance(estimates.covariance[k]) &&
        !is_small(error.covariance_in(k), estimates.covariance[k])) {
      ++near_;
    }
  }
}

bool AnchoredRuns::are_bounded() const {
  return static_cast<double>(near_) > kMostLeftOut * static_cast<double>(rows_);
}

void AnchoredRuns::move(StateRows& estimates, const std::filesystem::path& path,
                        std::vector<std::optional<TrueState>>& truths) {
  const auto row = move_to_anchor(anchor_, estimates, path, truths);
  if (!row) return;
  const StateRows given = estimates;
  const AnchorError error(anchor_, convention_, given, *row);
  if (error.is_known()) return;
  for (std::size_t k = 0; k < truths.size(); ++k) {
    if (!truths[k] || !is_covariance(given.covariance[k])) continue;
    const Eigen::MatrixXd part = error.covariance_in(k);
    if (are_bounded()) {
      estimates.covariance[k] = largest_covariance_of_difference(given.covariance[k], part);
    } else if (!is_small(part, given.covariance[k])) {
      truths[k].reset();
      ++removed_;
    }
  }
}

std::vector<std::string> AnchoredRuns::notes() const {
  if (are_bounded()) {
    return {formatted(
        "the first estimates, onto which --anchor moves the truths, are not known well beside the "
        "later ones (deviations up to {}): the moved errors are judged by an upper bound",
        of_deviation_)};
  }
  if (removed_ == 0) return {};
  return {formatted(
      "{} {} left out soon after the anchor, where its covariance is more than a thousandth of "
      "theirs in a direction",
      removed_, removed_ == 1 ? "estimate is" : "estimates are")};
}

}  // namespace montecarta::experiments
