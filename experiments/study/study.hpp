// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"
#include "experiments/study/cell_spec.hpp"
#include "experiments/study/settings.hpp"
#include "experiments/study/stopping_rule.hpp"
#include "experiments/worlds/world.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::experiments {

/// A study file, parsed and checked, with all defaults filled in. Nothing is simulated yet.
struct Study {
  Settings settings;
  std::vector<CellSpec> cells;
  World world;  ///< world of a simulation
  /// Recorded drives: one for all runs, or one for each run; empty in a simulation.
  std::vector<std::shared_ptr<const DriveLog>> logs;
  std::vector<std::filesystem::path> log_folders;  ///< {log} absolute path of its folder
  std::optional<StoppingRule> until;  ///< rule by which a cell stops early; nullopt: never
};

/// Known positions of the landmarks [m]: those of the world, or surveyed ones; may be empty.
const std::vector<Eigen::Vector2d>& landmarks_of(const Study& study);

/// Number of landmarks that detections can name; 0 if they have no identities.
std::size_t identities_of(const Study& study);

/// Reads a study file whose cells may name `filters`, which must outlive the study. `overrides` are
/// "section.key=value" as given to --set; "cells.cell=..." replaces all cells. Throws StudyError
/// with file, line, key and reason.
Study read_study(const std::filesystem::path& path, std::span<const FilterKind> filters,
                 std::span<const std::string> overrides = {});

/// Reads a study from a text. `name` stands before line numbers in errors. Relative paths of worlds
/// begin in `folder`.
Study parse_study(const std::string& text, const std::string& name,
                  const std::filesystem::path& folder, std::span<const FilterKind> filters,
                  std::span<const std::string> overrides = {});

/// Pairs (key, value) of a section as the resolved text has them: without settings that have no
/// effect and came after the first studies.
std::vector<std::pair<std::string, std::string>> stated_settings(const Settings& settings,
                                                                 const std::string& section);

/// The study file with all defaults filled in, including the world, in canonical order and
/// spelling. Reading it gives the same study and the same text, so its SHA-256 identifies the
/// study.
std::string resolved_text(const Study& study);

/// The settings, as given to --set, that the resolved text does not contain: the folders of
/// recorded drives, as absolute paths.
std::vector<std::string> settings_beside_text(const Study& study);

}  // namespace montecarta::experiments
