// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/study_facts.hpp"
#include "analysis/verdict/verdict.hpp"
#include "analysis/verdict/whole_error.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// How a verdict is taken that may be one of several in a study.
struct InterimAnalysis {
  double level = kUsualLevel;             ///< of all analyses together
  double within = kUsualMargin;           ///< margin of the verdict
  std::vector<std::uint64_t> looks = {};  ///< runs at each analysis; empty: there is one
  double share_of_runs = 1.0;             ///< of the study's that are at hand: less in a shard
};

/// The verdict on the errors of `complete` of the `ended` runs of a cell. "Consistent" needs
/// intervals of the level of this analysis. Where there are several analyses, a filter is refused
/// by intervals that spend one half of the error probability, and by bets, which hold at every
/// look, with the other half; of a part of the runs with its share of that half (STATISTICS 18).
Verdict judge(const WholeError& sums, const ErrorNames& names, const InterimAnalysis& analysis,
              std::uint64_t ended, std::uint64_t complete);

}  // namespace montecarta::analysis
