// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/study.hpp"

#include <string>

namespace montecarta::experiments {

/// Factors on the standard deviations of the controls and of the detections that a filter assumes.
struct NoiseFactors {
  double motion = 1.0;
  double sensor = 1.0;
};

/// The cell with the noise that it assumes multiplied by `factors`. Its options motion_noise and
/// sensor_noise are written with four digits. Throws StudyError if an option would leave its range.
CellSpec with_noise(CellSpec cell, const NoiseFactors& factors, const std::string& label);

/// The study of other cells alone. It stores poses and covariances at scans, and no cell stops
/// early.
Study study_of_cells(const Study& study, std::vector<CellSpec> cells, std::uint64_t runs,
                     std::uint64_t seed);

}  // namespace montecarta::experiments
