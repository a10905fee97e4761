// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/verdict/verdict.hpp"
#include "analysis/verdict/whole_error.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Share of the error probability `alpha` that interim analyses have spent when `information`, in
/// [0, 1], of the runs are there: 2 - 2 Phi(z / sqrt(information)), which resembles the boundaries
/// of O'Brien and Fleming (Lan and DeMets 1983).
double spent(double alpha, double information);

/// Level of the interim analysis of `runs` runs, where `looks` are the increasing numbers of runs
/// of all interim analyses. Each has the error probability that is spent since the one before, so
/// that together they reject with a probability of at most 1 - level, for any dependence between
/// them. Between two looks it is the level of the next one. Without looks it is `level`.
double level_of_look(double level, std::span<const std::uint64_t> looks, std::uint64_t runs);

/// How a verdict is taken that may be one of several in a study.
struct InterimAnalysis {
  double level = 0.95;                    ///< of all analyses together
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
