// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/imported_errors.hpp"

#include "analysis/run/nees.hpp"
#include "engine/numbers/real.hpp"

#include <span>
#include <vector>

namespace montecarta::analysis {

WhitenedRun unknown_errors(std::size_t dimension, std::size_t scans, std::uint64_t run) {
  const std::vector<double> unknown(scans * dimension, kNaN);
  return {dimension, unknown, unknown, std::vector<double>(dimension, 0.0), run};
}

void whiten_imported(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance,
                     double rounding, std::size_t scan, WhitenedRun& run) {
  const std::size_t d = run.dimension;
  const Eigen::VectorXd exact = Eigen::VectorXd::Zero(error.size());
  whiten(error, covariance, exact, std::span(run.whitened).subspan(d * scan, d),
         std::span(run.standardised).subspan(d * scan, d));
  add_errors_of_exact(error, covariance, exact, run.errors_of_exact, rounding);
}

}  // namespace montecarta::analysis
