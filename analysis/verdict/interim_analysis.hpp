// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/verdict/gate_scale.hpp"
#include "analysis/verdict/verdict.hpp"
#include "analysis/verdict/whole_error.hpp"
#include "engine/core/judgement.hpp"

#include <cstdint>
#include <vector>

namespace montecarta::analysis {

/// Settings of a verdict that may be one of several interim analyses of a study.
struct InterimAnalysis {
  double level = kUsualLevel;    ///< level of all interim analyses together
  double within = kUsualMargin;  ///< margin of the verdict
  /// {interim analysis} number of runs; empty if there is only one.
  std::vector<std::uint64_t> runs_at_analyses = {};
  /// Share of the study's runs that are judged: less than 1 in a shard.
  double share_of_runs = 1.0;
  const GateScale* gate = nullptr;  ///< size of what passed a gate; nullptr if there is no gate
};

/// The verdict on the errors of `complete` of the `ended` runs of a cell. The answer "consistent"
/// needs intervals of the level of this analysis. If there are several interim analyses, a filter
/// is refused by intervals that spend one half of the error probability, and by bets, which hold at
/// every analysis, with the other half. A shard spends its share of the latter half (STATISTICS
/// 18).
Verdict judge(const WholeError& sums, const ErrorNames& names, const InterimAnalysis& analysis,
              std::uint64_t ended, std::uint64_t complete);

}  // namespace montecarta::analysis
