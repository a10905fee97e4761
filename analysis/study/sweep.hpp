// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/study_analysis.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Cells that differ in one option only, the one that is swept.
struct SweepCurve {
  std::string name;  ///< filter, with the other options in which cells of the filter differ
  std::vector<const CellAnalysis*> cells;  ///< {value of the sweep} nullptr if there is no cell
};

/// An option that a study varies, which is a number, and its cells at each value.
struct Sweep {
  std::string option;               ///< name of the option, such as "particles"
  std::vector<std::string> values;  ///< values as the study has them, in increasing order
  std::vector<SweepCurve> curves;
};

/// All sweeps of a study, in the order of the options: of each option that takes at least three
/// values in cells that are equal otherwise. Cells with one value of it have no curve.
std::vector<Sweep> sweeps_of(const StudyAnalysis& study);

}  // namespace montecarta::analysis
