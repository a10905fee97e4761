// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/unusable_rows.hpp"

#include "engine/formatted.hpp"
#include "experiments/judging/difference_bound.hpp"

#include <array>

namespace montecarta::experiments {

UnusableRows::Fault UnusableRows::fault_of(const Eigen::MatrixXd& covariance) {
  if (!covariance.allFinite()) return not_finite;
  if ((covariance.diagonal().array() < 0.0).any()) return negative;
  // The same variances, with no correlation and the same asymmetry.
  const Eigen::MatrixXd asymmetry = 0.5 * (covariance - covariance.transpose());
  const Eigen::MatrixXd variances = covariance.diagonal().asDiagonal();
  return is_covariance(variances + asymmetry) ? not_semidefinite : not_symmetric;
}

void UnusableRows::add(const Eigen::MatrixXd& covariance, const std::string& place) {
  Count& count = counts_[fault_of(covariance)];
  if (count.rows++ == 0) count.first = place;
}

std::vector<std::string> UnusableRows::notes(const std::string& label) const {
  constexpr std::array kReasons = {"is not finite", "has a negative variance", "is not symmetric",
                                   "is not positive semidefinite"};
  std::vector<std::string> all;
  for (std::size_t fault = 0; fault < kReasons.size(); ++fault) {
    const Count& count = counts_[fault];
    if (count.rows == 0) continue;
    all.push_back(formatted(
        "{}: the covariance {} in {}{}, the first in {}: these samples are unusable", label,
        kReasons[fault], count.rows, count.rows == 1 ? " row" : " rows", count.first));
  }
  return all;
}

}  // namespace montecarta::experiments
