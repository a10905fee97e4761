// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/whitened_run.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>

namespace montecarta::analysis {

/// Errors of run number `run` at these scans, all NaN.
WhitenedRun unknown_errors(std::size_t dimension, std::size_t scans, std::uint64_t run);

/// Whitens an imported error with its covariance, at one scan of `run`. Errors up to `rounding` of
/// components that are known exactly are not counted.
void whiten_imported(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance,
                     double rounding, std::size_t scan, WhitenedRun& run);

}  // namespace montecarta::analysis
