// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/score_table.hpp"
#include "engine/core/plan.hpp"
#include "experiments/recordings/drive_log.hpp"
#include "experiments/study/cell_spec.hpp"
#include "experiments/study/settings.hpp"
#include "experiments/worlds/world.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The stopping rule study.until. With METRIC < HALF-WIDTH a cell stops when its mean is that
/// precise. With verdict it stops when its verdict is known. With verdict, N runs it does the same,
/// but "consistent" needs N runs.
struct Until {
  static constexpr double kLevel = 0.95;

  const Score* score = nullptr;  ///< nullptr: the verdict decides
  double half_width = 0.0;  ///< of the kLevel interval of the mean over runs, in the score's unit
  /// Number of runs that the verdict "consistent" needs, because an early stop would miss rare
  /// divergence.
  std::uint64_t least_runs = kUsualLeastRuns;
  static constexpr std::uint64_t kUsualLeastRuns = 300;
};

/// The rule in the canonical spelling of the resolved study.
std::string text_of(const Until& until);

/// The rule as a function that the engine calls between rounds. Failed runs are left out of means
/// and verdicts. A score that is not a number or has a heavy tail is never precise. A verdict is
/// not known if the cell was not tested.
EnoughRuns rule_of(const Until& until);

/// Description of the rule for `montecarta check`.
std::string in_words(const Until& until, std::uint64_t runs);

/// A study file, parsed and checked, with all defaults filled in. Nothing is simulated yet.
struct Study {
  Settings settings;
  std::vector<CellSpec> cells;
  World world;  ///< of a simulation
  /// Recorded drives: one for all runs, or one for each run; empty in a simulation.
  std::vector<std::shared_ptr<const DriveLog>> logs;
  std::optional<Until> until;  ///< when a cell stops early
};

/// Reads a study file. `overrides` are "section.key=value" as given to --set; "cells.cell=..."
/// replaces all cells. Throws StudyError with file, line, key and reason.
Study read_study(const std::filesystem::path& path, std::span<const std::string> overrides = {});

/// Reads a study from a text. `name` stands before line numbers in errors. Relative paths of worlds
/// begin in `folder`.
Study parse_study(const std::string& text, const std::string& name,
                  const std::filesystem::path& folder, std::span<const std::string> overrides = {});

/// The study file with all defaults filled in, including the world, in canonical order and
/// spelling. Reading it gives the same study and the same text, so its SHA-256 identifies the
/// study.
std::string resolved_text(const Study& study);

}  // namespace montecarta::experiments
