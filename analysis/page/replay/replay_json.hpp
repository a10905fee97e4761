// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/page/replay/replay.hpp"

#include <string>

namespace montecarta::analysis {

/// A run as the page's player reads it (page/script/replay.js).
std::string replay_json(const Replay& replay);

}  // namespace montecarta::analysis
