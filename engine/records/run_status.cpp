// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/run_status.hpp"

#include "engine/errors.hpp"

#include <algorithm>

namespace montecarta::engine {

void expect_known(std::span<const RunStatus> statuses, const std::string& place) {
  if (std::ranges::all_of(statuses, [](RunStatus s) { return s <= RunStatus::spared; })) return;
  throw RunError(place + ": a status is none of 0, 1, 2, 3 (the file is damaged): make it anew");
}

}  // namespace montecarta::engine
