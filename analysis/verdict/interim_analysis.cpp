// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/interim_analysis.hpp"

#include "analysis/statistics/distributions.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {

double spent(double alpha, double information) {
  if (!(information > 0.0)) return 0.0;
  return 2.0 * normal_cdf(normal_quantile(0.5 * alpha) / std::sqrt(information));
}

double level_of_look(double level, std::span<const std::uint64_t> looks, std::uint64_t runs) {
  if (looks.size() < 2) return level;
  const auto look = std::min(std::ranges::lower_bound(looks, runs), looks.end() - 1);
  const auto information = [&](std::uint64_t n) {
    return static_cast<double>(n) / static_cast<double>(looks.back());
  };
  constexpr double kLeastSpent = 1e-10;  // a level nearer to 1 has no exact complement
  const double before = look == looks.begin() ? 0.0 : spent(1.0 - level, information(*(look - 1)));
  return 1.0 - std::max(spent(1.0 - level, information(*look)) - before, kLeastSpent);
}

Verdict judge(const WholeError& sums, const ErrorNames& names, const InterimAnalysis& analysis,
              std::uint64_t ended, std::uint64_t complete) {
  const double within = analysis.within;
  const auto judged = [&](double level) {
    return judge(sums.families(level, names), level, within, complete, sums.beside_tests(names));
  };
  Verdict verdict = judged(level_of_look(analysis.level, analysis.looks, ended));
  if (analysis.looks.size() < 2) return verdict;
  const double half = 0.5 * (1.0 - analysis.level);
  const Verdict spent_half = judged(level_of_look(1.0 - half, analysis.looks, ended));
  verdict.is_refused = spent_half.is_refused;
  verdict.more_runs = spent_half.more_runs;
  const auto side = sums.refused_by_bets(within, 1.0 - half * analysis.share_of_runs);
  if (side) refuse_by_bets(*side, verdict);
  return verdict;
}

}  // namespace montecarta::analysis
