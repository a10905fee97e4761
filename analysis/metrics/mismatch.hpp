// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace montecarta::analysis {

struct StudyAnalysis;

/// Factors on the standard deviations of the study's belief, for a filter that is given wrong
/// noise.
struct Mismatch {
  double motion_noise = 1.0;
  double sensor_noise = 1.0;
  std::string family = {};  ///< the cell's label without them: cells of one family differ in
                            ///< nothing else
};
Mismatch mismatch_of(const StoredCell& cell);

/// A family of cells over both factors.
struct MismatchGrid {
  std::string family;
  std::vector<double> motion_noise;  ///< increasing
  std::vector<double> sensor_noise;  ///< increasing
  /// Mean ANEES of the pose per component, {motion, sensor}; NaN where there is no tested cell.
  Eigen::MatrixXd anees;
};

/// Every family with at least two factors of each kind, in the order of the study.
std::vector<MismatchGrid> mismatch_grids(const StudyAnalysis& study);

}  // namespace montecarta::analysis
