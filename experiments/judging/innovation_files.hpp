// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/estimate_files.hpp"

namespace montecarta::experiments {

/// Innovations alone in CSV files, one for each run, without states and truths. Their columns are
/// those of read_innovations().
class InnovationFiles final : public EstimateFiles {
 public:
  explicit InnovationFiles(JudgedFiles files)
      : EstimateFiles(std::move(files), 0.0, EqualTimes::refuse) {}

  /// The times of the file; rows of one time are one scan.
  std::vector<double> times(std::size_t cell, std::size_t run) const override;
  /// Rows without a state.
  StateRows estimates(std::size_t cell, std::size_t run) const override;
};

}  // namespace montecarta::experiments
