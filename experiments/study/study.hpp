// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/score.hpp"
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

/// study.until = METRIC < HALF-WIDTH: a cell stops when so precise; or verdict: when its verdict is
/// known; or verdict, N runs: likewise, with another number of runs that "consistent" needs.
struct Until {
  static constexpr double kLevel = 0.95;

  const Score* score = nullptr;  ///< nullptr: the verdict
  double half_width = 0.0;  ///< of the kLevel interval of the mean over runs, in the score's unit
  /// A cell is not called consistent before so many runs: rare divergence is what an early end
  /// misses.
  std::uint64_t least_runs = kUsualLeastRuns;
  static constexpr std::uint64_t kUsualLeastRuns = 300;
};

/// nullopt where `text` is empty: all runs are made. Throws StudyError, beginning with `place`,
/// where it is not understood, or names what no result follows from (processor time).
std::optional<Until> parse_until(const std::string& text, const std::string& place);

/// In the one spelling that the resolved study uses.
std::string text_of(const Until& until);

/// The question the engine asks between rounds. Failed runs are in no mean and no verdict; a score
/// that is not a number, or has a heavy tail, is never precise; what was not tested is not known.
EnoughRuns rule_of(const Until& until);

/// For `montecarta check`: when a cell stops, in words.
std::string in_words(const Until& until, std::uint64_t runs);

/// A study file understood: everything filled in and checked, nothing built yet.
struct Study {
  Settings settings;
  std::vector<CellSpec> cells;
  World world;                          ///< of a simulation
  std::shared_ptr<const DriveLog> log;  ///< nullptr in a simulation
  /// {run} Where every run is a drive of its own, the first one being `log`; else empty.
  std::vector<std::shared_ptr<const DriveLog>> own_logs;
  std::optional<Until> until;  ///< when a cell stops early
};

/// Reads a study file. `overrides` are "section.key=value" as given to --set; "cells.cell=..."
/// replaces all cells. Throws StudyError naming file, line, key and reason.
Study read_study(const std::filesystem::path& path, std::span<const std::string> overrides = {});

/// Likewise from text; `name` stands before line numbers, `folder` is where relative world paths
/// begin.
Study parse_study(const std::string& text, const std::string& name,
                  const std::filesystem::path& folder, std::span<const std::string> overrides = {});

/// The study file with everything filled in, world included, in one order and spelling: reading it
/// gives the same study and the same text, so that its SHA-256 names the study.
std::string resolved_text(const Study& study);

}  // namespace montecarta::experiments
