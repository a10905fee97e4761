// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/setup/filter_setup.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace montecarta::experiments {

// What a program may answer, checked: whatever bytes it says, the result is as promised here or a
// ProgramError with the reason. EXTERNAL_FILTERS.md describes the lines.

/// What a program believes after a scan, or between scans.
struct ProgramEstimate {
  PoseMoments pose;   ///< finite; covariance symmetric, no eigenvalue negative but for rounding
  ScanReport report;  ///< what it said of; else zero
};

/// The answer to `start`, message number `id` of its run.
void read_started(std::string_view line, std::uint64_t id);

/// The answer to `scan` or `predict`.
ProgramEstimate read_estimate(std::string_view line, std::uint64_t id);

/// The answer to `map`: into `landmarks`, by number; nullopt where it names none. With known
/// association a number beyond them is an error; else it is a new landmark that the study has no
/// row for.
void read_map(std::string_view line, std::uint64_t id, Association association,
              std::span<std::optional<LandmarkEstimate>> landmarks);

}  // namespace montecarta::experiments
