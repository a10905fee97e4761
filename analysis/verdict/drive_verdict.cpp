// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/drive_verdict.hpp"

#include "analysis/run/nees.hpp"
#include "analysis/statistics/correlated_average.hpp"
#include "analysis/statistics/interval.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

/// With fewer effective samples, the errors may as well be one error that lasts for the whole
/// drive.
constexpr double kFewestEffective = 3.0;

/// Means over runs on one drive: the interval of each run is valid, and the runs are not
/// independent.
CorrelatedAverage mean_over_runs(std::span<const DriveScores> runs, std::size_t block) {
  const auto is_judged = [&](const DriveScores& run) {
    return run.blocks[block].effective_samples > 0.0;
  };
  const auto n = static_cast<double>(std::ranges::count_if(runs, is_judged));
  CorrelatedAverage mean;
  if (n == 0.0) return mean;
  double inverse = 0.0;
  for (const DriveScores& run : runs) {
    if (!is_judged(run)) continue;
    const CorrelatedAverage& one = run.blocks[block];
    mean.mean += one.mean / n;
    mean.ratio.lower += one.ratio.lower / n;
    mean.ratio.upper += one.ratio.upper / n;
    inverse += 1.0 / one.effective_samples / n;
  }
  mean.effective_samples = 1.0 / inverse;
  return mean;
}

DriveScores mean_scores(std::span<const DriveScores> runs) {
  DriveScores all = runs.front();
  all.median = all.ratio_without_outliers = 0.0;
  for (std::size_t block = 0; block < all.blocks.size(); ++block) {
    all.blocks[block] = mean_over_runs(runs, block);
  }
  for (const DriveScores& run : runs) {
    all.median += run.median / static_cast<double>(runs.size());
    all.ratio_without_outliers += run.ratio_without_outliers / static_cast<double>(runs.size());
    all.outliers = std::max(all.outliers, run.outliers);
    all.in_gaps = std::max(all.in_gaps, run.in_gaps);
    all.undefined = std::max(all.undefined, run.undefined);
    all.fixes = std::min(all.fixes, run.fixes);
    all.is_the_reference = all.is_the_reference || run.is_the_reference;
    all.is_below_reference = all.is_below_reference || run.is_below_reference;
  }
  return all;
}

Answer answer_of_drive(const Interval& ratio, double within) {
  if (ratio.lower >= 1.0 / within && ratio.upper <= within) return Answer::consistent;
  if (ratio.lower > 1.0) return Answer::optimistic;
  return ratio.upper < 1.0 ? Answer::conservative : Answer::undecided;
}

/// The average over the runs that have the block.
CorrelatedAverage over_own_drives(std::span<const DriveScores> runs, std::size_t block,
                                  double level) {
  std::vector<VectorSeries> drives;
  for (const DriveScores& run : runs) {
    if (run.blocks[block].effective_samples > 0.0) drives.push_back(run.errors[block]);
  }
  return drives.empty() ? CorrelatedAverage{} : correlated_average(drives, level);
}

DriveScores sums_over_drives(std::span<const DriveScores> runs, double level) {
  DriveScores all;
  all.leading = runs.front().leading;
  all.median = all.ratio_without_outliers = 0.0;
  double judged = 0.0;
  for (std::size_t block = 0; block < all.blocks.size(); ++block) {
    all.blocks[block] = over_own_drives(runs, block, level);
  }
  for (const DriveScores& run : runs) {
    all.in_gaps += run.in_gaps;
    all.undefined += run.undefined;
    if (!(run.leads().effective_samples > 0.0)) continue;
    judged += 1.0;
    all.median += run.median;
    all.ratio_without_outliers += run.ratio_without_outliers;
    all.outliers += run.outliers;
    all.fixes += run.fixes;
    all.seconds += run.seconds;
    all.is_the_reference = all.is_the_reference || run.is_the_reference;
    all.is_below_reference = all.is_below_reference || run.is_below_reference;
  }
  all.median /= judged;
  all.ratio_without_outliers /= judged;
  return all;
}

/// Fills answer and minutes from the mean.
void decide(double level, DriveConsistency& result) {
  const CorrelatedAverage& leads = result.mean.leads();
  if (!(leads.effective_samples > 0.0) || result.mean.is_the_reference) return;
  result.answer = answer_of_drive(leads.ratio, result.within);
  result.minutes = result.mean.seconds / 60.0 *
                   samples_that_decide(dimension_of(result.mean.leading), level, result.within) /
                   leads.effective_samples;
}

std::string drives_text(const DriveConsistency& found) {
  const std::string these = found.drives == 1
                                ? "one judged drive cannot tell"
                                : std::to_string(found.drives) + " drives cannot tell";
  const double needed =
      static_cast<double>(found.drives) * found.minutes * 60.0 / found.mean.seconds;
  if (!std::isfinite(needed)) return these + ", nor could more";
  return these + ": it would take " + compact(std::ceil(needed)) + " like them";
}

std::string needed_text(const DriveConsistency& drive) {
  if (drive.drives > 0) return drives_text(drive);
  if (std::isinf(drive.minutes)) return "this drive cannot tell, nor could a longer one";
  const bool is_least = drive.mean.leads().effective_samples < kFewestEffective;
  return std::string("this drive cannot tell: it would need ") + (is_least ? "at least " : "") +
         duration_text(60.0 * std::max(drive.minutes, 1.0));
}

/// A range of factors in words: "1.2 to 1.4", "more than 1.2".
std::string factor_words(double lower, double upper) {
  if (std::isinf(upper)) return "more than " + compact(lower);
  return compact(lower) + " to " + compact(upper);
}

}  // namespace

DriveConsistency judge_drive(std::span<const DriveScores> runs, double level, double within) {
  DriveConsistency result;
  result.within = within;
  if (runs.empty()) return result;
  result.mean = mean_scores(runs);
  decide(level, result);
  return result;
}

DriveConsistency judge_own_drives(std::span<const DriveScores> runs, double level, double within) {
  DriveConsistency result;
  result.within = within;
  result.drives = static_cast<std::size_t>(std::ranges::count_if(
      runs, [](const DriveScores& run) { return run.leads().effective_samples > 0.0; }));
  if (runs.empty()) return result;
  result.mean = sums_over_drives(runs, level);
  decide(level, result);
  return result;
}

std::string in_words(const DriveConsistency& drive) {
  const Interval& ratio = drive.mean.leads().ratio;
  switch (drive.answer) {
    case Answer::consistent:
      return "consistent within " + exact_text(drive.within);
    case Answer::optimistic:
      return "optimistic: NEES " + factor_words(ratio.lower, ratio.upper) + " times too large";
    case Answer::conservative:
      return "conservative: NEES " + factor_words(1.0 / ratio.upper, 1.0 / ratio.lower) +
             " times too small";
    case Answer::undecided:
      return needed_text(drive);
    case Answer::inconsistent:
    case Answer::untested:
      break;
  }
  return drive.mean.is_the_reference ? "refused: the reference is this estimate" : "not tested";
}

}  // namespace montecarta::analysis
