// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/figure.hpp"
#include "engine/records/result_file.hpp"

#include <cstdint>
#include <optional>

namespace montecarta::analysis {

/// The true and the estimated path of one run, a panel a cell, with landmarks (estimated ones where
/// the map is stored) and ellipses of two standard deviations; of a recorded drive the fixes of the
/// leading reference in place of the truth. Without `run`: the first run that is
/// complete in every cell, else in most. No data where no cell is complete. Throws StudyError where
/// the file does not hold `run`.
Figure path_figure(const ResultFile& file, std::optional<std::uint64_t> run);

}  // namespace montecarta::analysis
