// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/threads/parallel.hpp"
#include "tests/doubles/scripted_drives.hpp"
#include "tests/doubles/scripted_filter.hpp"

#include <string>
#include <utility>

namespace montecarta::engine {

/// A cell with a filter that follows a script.
inline Cell scripted_cell(std::string label, const ScriptedFilter::Script& script) {
  Cell cell;
  cell.label = std::move(label);
  cell.filter = "scripted";
  cell.long_name = "Scripted, " + std::to_string(script.particles) + " particles";
  cell.particles = script.particles;
  cell.reports.mixture = true;
  cell.landmarks = script.landmarks;
  cell.settings = {{"particles", std::to_string(script.particles)}};
  cell.make_filter = [script] { return std::make_unique<ScriptedFilter>(script); };
  return cell;
}

/// A small study of scripted drives with every column; the caller adds cells.
inline StudyPlan scripted_study(std::uint64_t runs, std::size_t steps) {
  StudyPlan plan;
  plan.name = "scripted";
  plan.title = "A study that follows a script";
  plan.seed = 7;
  plan.runs = runs;
  plan.last_run = runs;
  plan.columns = {.particles = true, .map = true};
  plan.drives = std::make_shared<ScriptedDrives>(steps, plan.seed);
  plan.scenario = {{"kind", "scripted"}};
  plan.resolved_text = "[study]\nname = scripted\nruns = " + std::to_string(runs) + "\n";
  return plan;
}

/// Two cells, of which one fails in run 3; the other is large enough for loops on spare threads.
inline StudyPlan scripted_cells(std::uint64_t runs, std::chrono::microseconds pace = {}) {
  StudyPlan plan = scripted_study(runs, 40);
  plan.cells = {scripted_cell("small", {.particles = 5, .mishap = Mishap{.run = 3}, .pace = pace}),
                scripted_cell("large", {.particles = SpareThreads::kLeastParticles, .pace = pace})};
  return plan;
}

}  // namespace montecarta::engine
