// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_columns.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The row that is kept if neighbouring rows have the same time: none, which is an error, or one.
enum class EqualTimes : std::uint8_t { refuse, keep_first, keep_last };

/// Estimates or truths of one run, as read from a file.
struct StateRows {
  StateShape shape = {};
  std::vector<double> time = {};                 ///< [s] {row}, increasing
  std::vector<Eigen::VectorXd> state = {};       ///< {row}{width}, quaternions of length 1
  std::vector<Eigen::MatrixXd> covariance = {};  ///< {row}{d, d} as in the file; empty if not read
  std::vector<double> nis = {};                  ///< {row} empty if the file has none
  std::vector<std::uint32_t> nis_dof = {};       ///< {row} empty if the file has none
  std::uint64_t unwrapped_innovations = 0;       ///< number of innovations with an angle beyond pi
  std::string first_unwrapped = {};              ///< file and line of the first of them
  std::vector<std::size_t> line = {};            ///< {row} line in the file
  std::uint64_t left_out = 0;                    ///< number of rows not kept because of EqualTimes
  std::string uncorrelated = {};  ///< covariances that the file does not have; empty: it has all
};

}  // namespace montecarta::experiments
