// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/estimate_source.hpp"
#include "experiments/judging/run_files.hpp"

#include <string>
#include <vector>

namespace montecarta::experiments {

/// Estimates in CSV files, one for each run, with innovations beside them. The truths are in files
/// of their own, or in columns of the estimates; or the files have errors.
class EstimateFiles : public EstimateSource {
 public:
  struct Reading {
    double tolerance = 0.0;  ///< [s] of the times of innovations
    EqualTimes equal_times = EqualTimes::refuse;
    OwnTruth own_truth = OwnTruth::none;
    bool truth_covariance = false;  ///< whether truths have covariances, which are read
    bool is_pair = false;           ///< whether truths are the files of a second estimator
  };
  EstimateFiles(JudgedFiles files, const Reading& how);

  const std::vector<std::string>& cells() const override { return cells_; }
  const std::vector<std::uint64_t>& runs() const override { return files_.runs; }
  std::filesystem::path place(std::size_t cell, std::size_t run) const override {
    return files_.cells[cell].of_run[run];
  }
  std::filesystem::path truth_place(std::size_t cell, std::size_t run) const override {
    return has_common_truths() ? files_.truth[run] : place(cell, run);
  }
  std::vector<double> times(std::size_t cell, std::size_t run) const override;
  StateRows estimates(std::size_t cell, std::size_t run) const override;
  StateRows truth(std::size_t cell, std::size_t run, const StateShape& shape) const override;
  bool has_common_truths() const override { return how_.own_truth == OwnTruth::none; }
  bool has_errors() const override { return how_.own_truth == OwnTruth::errors; }
  TextPairs contents() const override;
  std::vector<std::string> notes() const override;

 private:
  JudgedFiles files_;
  std::vector<std::string> cells_;
  Reading how_;
};

}  // namespace montecarta::experiments
