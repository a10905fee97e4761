// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/score.hpp"
#include "engine/core/plan.hpp"

#include <optional>
#include <string>

namespace montecarta::experiments {

/// study.until = METRIC < HALF-WIDTH: a cell stops when so precise; or verdict: when its verdict is
/// known.
struct Until {
  static constexpr double kLevel = 0.95;

  const Score* score = nullptr;  ///< nullptr: the verdict
  double half_width = 0.0;  ///< of the kLevel interval of the mean over runs, in the score's unit
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

}  // namespace montecarta::experiments
