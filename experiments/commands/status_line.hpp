// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace montecarta::experiments {

/// How far to look into a file.
enum class Depth { statuses, every_byte };

/// What scripts read of one file, separated by tabs: name, state (complete, unfinished, damaged),
/// SHA-256 of the study, runs of cells complete, failed, missing, wall time [s], what is wrong.
/// Never throws: a file that cannot be read is damaged.
std::string status_line(const std::string& name, Depth depth);

}  // namespace montecarta::experiments
