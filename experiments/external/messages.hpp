// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "filters/setup/filter_setup.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace montecarta::experiments {

// What a program is told, one line of JSON a message; EXTERNAL_FILTERS.md describes them. Numbers
// are the shortest text that reads back as the same bits.

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

}  // namespace montecarta::experiments
