// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/render/page/replay/replay.hpp"

#include <string>

namespace montecarta::analysis {

/// The last moment of a replay as a drawing (SVG), with the first cells as the player shows them.
std::string replay_still(const Replay& replay);

}  // namespace montecarta::analysis
