// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/slam_filter.hpp"
#include "filters/setup/filter_setup.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::experiments {

// Messages to a program, each one line of JSON; EXTERNAL_FILTERS.md describes them. Every number
// reads back as the same bits.

/// The control of one step: its components, then the duration [s].
using ControlRow = std::vector<double>;

/// The start of a run.
struct RunStart {
  std::uint64_t run;
  std::uint32_t seed;  ///< seed of the program's generator; a pure function of study and run
  Pose pose;
};

std::string start_message(std::uint64_t id, const RunStart& start, const FilterSetup& setup);
std::string predict_message(std::uint64_t id, std::span<const ControlRow> controls);
/// Identities are sent with known association only; -1 stands for a false alarm or an unknown
/// landmark. `components` is the number of components of a detection.
std::string scan_message(std::uint64_t id, std::span<const ControlRow> controls, Scan scan,
                         Association association, std::size_t components);
std::string map_message(std::uint64_t id);

// Readers of a program's answers. For any bytes that it sends, they return a result as documented
// here or throw ProgramError with the reason. EXTERNAL_FILTERS.md describes the lines.

/// Estimate of a program after a scan or between scans.
struct ProgramEstimate {
  PoseMoments pose;  ///< finite; covariance symmetric, without eigenvalues that are negative beyond
                     ///< rounding
  ScanReport report;  ///< zero for members that the answer omits
};

/// Reads the answer to `start`, which is message number `id` of its run.
void read_started(std::string_view line, std::uint64_t id);

/// Reads the answer to `scan` or `predict`.
ProgramEstimate read_estimate(std::string_view line, std::uint64_t id);

/// Reads the answer to `map` into `landmarks`, ordered by number, which must be nullopt before.
/// With known association a number beyond the end is an error. Otherwise it belongs to a new
/// landmark for which the study has no row, and is ignored.
void read_map(std::string_view line, std::uint64_t id, Association association,
              std::span<std::optional<LandmarkEstimate>> landmarks);

}  // namespace montecarta::experiments
