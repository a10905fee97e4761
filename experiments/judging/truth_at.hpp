// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_rows.hpp"

#include <Eigen/Core>

#include <filesystem>

namespace montecarta::experiments {

/// The method that finds the truth at the time of an estimate.
struct TimeMatch {
  double tolerance = 1e-6;   ///< [s] largest difference of times that are the same
  bool interpolate = false;  ///< whether to interpolate linearly, with angles the shorter way round
};

/// The state of `truth` at `time`. Throws StudyError if there is none; the error names the files
/// `estimate` and `truths`.
Eigen::VectorXd truth_at(const StateRows& truth, double time, const TimeMatch& match,
                         const std::filesystem::path& estimate,
                         const std::filesystem::path& truths);

}  // namespace montecarta::experiments
