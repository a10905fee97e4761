// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/figures/path_bounds.hpp"
#include "analysis/output/figure.hpp"
#include "engine/records/result_file.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// What is drawn of one cell: files of path_data.hpp, those without rows are left out.
struct DrawnPath {
  std::string label;
  std::size_t style = 0;  ///< for line_colour()
  FigureData path, poses, map;
};

/// A map for each cell, with the true landmarks and the fixes of the reference on all of them.
Chart path_chart(const std::vector<DrawnPath>& cells, const FigureData& landmarks,
                 const FigureData& fixes, const Bounds& bounds);

/// The true and the estimated path of one run, a panel a cell, with landmarks (estimated ones where
/// the map is stored) and ellipses of two standard deviations; of a recorded drive the fixes of the
/// leading reference in place of the truth. Without `run`: the first run that is
/// complete in every cell, else in most. No data where no cell is complete. Throws StudyError where
/// the file does not hold `run`.
Figure path_figure(const ResultFile& file, std::optional<std::uint64_t> run);

}  // namespace montecarta::analysis
