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

// What a program is told, one line of JSON a message; EXTERNAL_FILTERS.md describes them. Numbers
// are texts that read back as the same bits.

/// One control step: the controls of the vehicle, then its duration [s].
using ControlRow = std::vector<double>;

/// A run that begins.
struct RunStart {
  std::uint64_t run;
  std::uint32_t seed;  ///< for the program's generator: a pure function of study and run
  Pose pose;
};

std::string start_message(std::uint64_t id, const RunStart& start, const FilterSetup& setup);
std::string predict_message(std::uint64_t id, std::span<const ControlRow> controls);
/// Identities are told with known association only; -1 is a false alarm, or unknown. `components`
/// of a detection.
std::string scan_message(std::uint64_t id, std::span<const ControlRow> controls, Scan scan,
                         Association association, std::size_t components);
std::string map_message(std::uint64_t id);

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
