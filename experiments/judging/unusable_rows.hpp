// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Counts estimates whose covariance is none, by what is wrong with it.
class UnusableRows {
 public:
  /// Adds a covariance that is none, in the row at `place` (file and line).
  void add(const Eigen::MatrixXd& covariance, const std::string& place);
  /// A sentence for each fault, of the estimator `label`.
  std::vector<std::string> notes(const std::string& label) const;

 private:
  enum Fault : std::uint8_t { not_finite, negative, not_symmetric, not_semidefinite };
  struct Count {
    std::uint64_t rows = 0;
    std::string first;  ///< file and line
  };
  static Fault fault_of(const Eigen::MatrixXd& covariance);

  Count counts_[not_semidefinite + 1];
};

}  // namespace montecarta::experiments
