// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_rows.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Reads estimates (mean and covariance over time) from CSV. Throws StudyError with file, line and
/// remedy if the file is empty or damaged, or a number is not finite, or if times or angles are in
/// another unit than their columns say.
StateRows read_estimates(const std::filesystem::path& path, EqualTimes equal = EqualTimes::refuse);

/// {row} The times [s] in a file of estimates. Throws StudyError if they do not increase.
std::vector<double> times_in(const std::filesystem::path& path,
                             EqualTimes equal = EqualTimes::refuse);

/// How truths are read.
struct TruthReading {
  EqualTimes equal = EqualTimes::refuse;
  bool with_covariance = false;  ///< whether to read the covariance of the truth's own error
  std::string prefix = {};       ///< with which the names of its columns begin
};

/// Reads a truth of the same state; other columns are ignored. Throws like read_estimates(), also
/// if a covariance is none.
StateRows read_truth(const std::filesystem::path& path, const StateShape& shape,
                     const TruthReading& how = {});

}  // namespace montecarta::experiments
