// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/runs/monte_carlo.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/study/make_plan.hpp"
#include "experiments/study/study.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// A vehicle in a loop of 40 m with five landmarks: enough for a real filter, and quickly run.
inline const std::string kTinyLoop = R"([study]
name = tiny
runs = 6
[scenario]
world = inline
speed = 2
control_rate = 10
scan_rate = 5
wheelbase = 1
steer_rate_limit_deg = 90
[cells]
cell = ekf_slam
[record]
columns = pose, covariance, final_map
[world]
waypoint = 10, 0
waypoint = 10, 10
waypoint = 0, 10
waypoint = 0, 0
landmark = 5, 3
landmark = 13, 5
landmark = 6, 13
landmark = -3, 6
landmark = 4, 6
)";

/// Runs a study and leaves its result at `path`.
inline void write_studied_result(const std::filesystem::path& path, const std::string& text,
                                 const std::vector<std::string>& overrides = {}) {
  const experiments::Study study =
      experiments::parse_study(text, "tiny.ini", ".", experiments::known_filters(), overrides);
  run_study(experiments::make_plan(study, {}), {.output = path, .force = true, .quiet = true});
}

}  // namespace montecarta::analysis
