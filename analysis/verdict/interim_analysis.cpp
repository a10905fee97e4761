// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/interim_analysis.hpp"

#include "analysis/statistics/error_spending.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace montecarta::analysis {

Verdict judge(const WholeError& sums, const ErrorNames& names, const InterimAnalysis& analysis,
              std::uint64_t ended, std::uint64_t complete) {
  const double within = analysis.within;
  const auto judged = [&](double level) {
    return judge(sums.families(level, names, analysis.gate), level, within, complete,
                 sums.beside_tests(names));
  };
  Verdict verdict = judged(level_of_analysis(analysis.level, analysis.runs_at_analyses, ended));
  if (analysis.runs_at_analyses.size() < 2) return verdict;
  const double half = 0.5 * (1.0 - analysis.level);
  const Verdict spent_half =
      judged(level_of_analysis(1.0 - half, analysis.runs_at_analyses, ended));
  verdict.is_refused = spent_half.is_refused;
  verdict.more_runs = spent_half.more_runs;
  const auto side = sums.refused_by_bets(within, 1.0 - half * analysis.share_of_runs);
  if (side) refuse_by_bets(*side, verdict);
  return verdict;
}

}  // namespace montecarta::analysis
