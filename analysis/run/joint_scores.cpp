// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/joint_scores.hpp"

#include "analysis/statistics/spread.hpp"
#include "engine/numbers/angle.hpp"

#include <Eigen/Cholesky>

#include <cmath>

namespace montecarta::analysis {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// e' P^-1 e by Cholesky of the correlation matrix, so that the pivots are independent of units.
double quadratic_form(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  if (!error.allFinite() || !covariance.allFinite() || !scale.allFinite()) return kNaN;
  const Eigen::LLT<Eigen::MatrixXd> L(scale.asDiagonal() * covariance * scale.asDiagonal());
  if (L.info() != Eigen::Success) return kNaN;
  return L.matrixL().solve(scale.cwiseProduct(error)).squaredNorm();
}

/// Errors of the pose and of each landmark that is in the map and has a known position.
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

}  // namespace

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

}  // namespace montecarta::analysis
