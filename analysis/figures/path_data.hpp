// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/output/figure.hpp"
#include "engine/records/result_file.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace montecarta::analysis {

/// Index in the file of the run that is shown: `run`, or else the first that is complete in every
/// cell, else in most; none where no cell is complete. Throws StudyError where the file does not
/// hold `run`.
std::optional<std::size_t> chosen_run(const ResultFile& file, std::optional<std::uint64_t> run);

/// How many ellipses of the pose lie along a path.
inline constexpr std::size_t kPoseEllipses = 16;

/// (time, true x, true y, x, y) at up to some hundred scans of a run; (time, x, y) where nobody
/// knows the truth.
FigureData path_data(const ResultFile& file, const StoredCell& cell, const RunRows& run);
/// Two-sigma ellipses of the pose at kPoseEllipses moments; no rows without covariance.
FigureData pose_ellipses(const StoredCell& cell, const RunRows& run);
/// Two-sigma ellipses of the landmarks that the filter has at the last scan; no rows where neither
/// the map nor the final map is stored.
FigureData map_data(const ResultFile& file, const StoredCell& cell, std::size_t run_index);
/// (time, x, y) of up to some hundred fixes of the leading reference; no rows where there is none.
FigureData fix_data(const ResultFile& file, std::size_t run_index);
/// True landmarks in a run.
FigureData landmark_data(const ResultFile& file, std::size_t run_index);

}  // namespace montecarta::analysis
