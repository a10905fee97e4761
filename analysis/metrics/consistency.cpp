// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/consistency.hpp"

#include "analysis/output/number_text.hpp"
#include "analysis/statistics/bootstrap.hpp"
#include "analysis/statistics/nees_power.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/errors.hpp"

#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

/// The ratio of a scan to what it should be, by the band for all scans: above 1 where the scan is
/// above the band.
Interval ratio_of_scan(const NeesSeries& series, std::size_t s) {
  const Interval& band = series.whole_run_bounds[s];
  return {series.average[s] / band.upper, series.average[s] / band.lower};
}

/// Shares of scans in the pointwise band.
void count_shares(const NeesSeries& series, Consistency& result) {
  std::size_t tested = 0, n_above = 0, n_below = 0;
  for (std::size_t s = 0; s < series.average.size(); ++s) {
    const double average = series.average[s];
    if (std::isnan(average)) continue;
    ++tested;
    n_above += average > series.bounds[s].upper ? 1 : 0;
    n_below += average < series.bounds[s].lower ? 1 : 0;
  }
  const auto share = [&](std::size_t n) {
    return tested == 0 ? kNaN : static_cast<double>(n) / static_cast<double>(tested);
  };
  result.share_above = share(n_above);
  result.share_below = share(n_below);
  result.share_inside = share(tested - n_above - n_below);
}

/// Scans against the band for all of them.
void compare_scans(const NeesSeries& series, std::span<const double> times, Consistency& result) {
  for (std::size_t s = 0; s < series.average.size(); ++s) {
    if (std::isnan(series.average[s])) continue;
    const Interval ratio = ratio_of_scan(series, s);
    const bool above = ratio.lower > 1.0, below = ratio.upper < 1.0;
    if (above && !result.above_from) result.above_from = times[s];
    if (below && !result.below_from) result.below_from = times[s];
    if (above && !result.stays_above_from) result.stays_above_from = times[s];
    if (below && !result.stays_below_from) result.stays_below_from = times[s];
    if (!above) result.stays_above_from.reset();
    if (!below) result.stays_below_from.reset();
    if (above && (!result.highest || ratio.lower > result.highest->ratio.lower)) {
      result.highest = {ratio, times[s]};
    }
    if (below && (!result.lowest || ratio.upper < result.lowest->ratio.upper)) {
      result.lowest = {ratio, times[s]};
    }
  }
}

/// The average over the run: where it should be, and where its ratio to that lies.
void compare_average(const NeesSeries& series, Consistency& result) {
  const std::vector<double>& averages = series.run_averages;
  const auto d = static_cast<double>(series.dimension);
  const AverageLaw law = average_law(averages, series.dimension, series.test.average_deviate,
                                     series.test.average_skew);
  const Interval right = law.bounds();
  result.average_bounds = {d * right.lower, d * right.upper};
  result.ratio = {result.mean / result.average_bounds.upper,
                  result.mean / result.average_bounds.lower};
  result.least_ratios = least_ratios(law, kPowerSaid);
  result.is_overdispersed = is_overdispersed(averages, series.dimension);
  if (result.is_overdispersed) {
    const Interval mean = bootstrap_mean(averages, series.test.average_level);
    result.ratio = {mean.lower / d, mean.upper / d};
  } else if (law.runs >= 3.0) {
    const std::uint64_t enough = runs_that_decide(law, result.within);
    result.more_runs = enough - std::min<std::uint64_t>(enough, averages.size());
  }
}

bool is_within(const Interval& ratio, double margin) {
  return ratio.lower >= 1.0 / margin && ratio.upper <= margin;
}

Verdict verdict_of(const Consistency& found) {
  if (std::isnan(found.share_inside)) return Verdict::untested;
  const bool is_off_somewhere = (found.highest && found.highest->ratio.lower > found.within) ||
                                (found.lowest && found.lowest->ratio.upper < 1.0 / found.within);
  if (is_within(found.ratio, found.within) && !is_off_somewhere) return Verdict::consistent;
  if (found.above_from || found.mean > found.average_bounds.upper) return Verdict::optimistic;
  if (found.below_from || found.mean < found.average_bounds.lower) return Verdict::conservative;
  return Verdict::undecided;
}

/// " by 1.02 to 1.15", or of the scan that is farthest outside where the run as a whole is not.
std::string how_far(const Consistency& found) {
  const bool is_above = found.verdict == Verdict::optimistic;
  const bool by_average =
      is_above ? found.mean > found.average_bounds.upper : found.mean < found.average_bounds.lower;
  const std::optional<ScanRatio>& scan = is_above ? found.highest : found.lowest;
  if (by_average ? std::isnan(found.ratio.lower) : !scan) return "";
  Interval ratio = by_average ? found.ratio : scan->ratio;
  // A few lost runs leave the interval of the mean wide, but that it is off is shown.
  (is_above ? ratio.lower : ratio.upper) =
      is_above ? std::max(ratio.lower, 1.0) : std::min(ratio.upper, 1.0);
  const std::string words = " by " + compact(ratio.lower) + " to " + compact(ratio.upper);
  return by_average ? words : words + " at " + fixed_seconds(scan->time);
}

std::string what_decides(const Consistency& found) {
  if (!found.more_runs) return "undecided: too few runs";
  return "undecided: " + std::to_string(*found.more_runs) + " more runs decide";
}

/// " (3 of 300 runs failed, 20 of 9600 samples are unusable)"; empty if there are none.
std::string exceptions_of(const Consistency& found) {
  std::string words;
  if (found.failed > 0) {
    words = std::to_string(found.failed) + " of " + std::to_string(found.runs) + " runs failed";
  }
  if (found.unusable > 0) {
    words += (words.empty() ? "" : ", ") + std::to_string(found.unusable) + " of " +
             std::to_string(found.samples) + " samples are unusable";
  }
  return words.empty() ? words : " (" + words + ")";
}

}  // namespace

std::optional<std::size_t> first_lasting(const std::vector<bool>& above, std::size_t length) {
  std::size_t in_a_row = 0;
  for (std::size_t s = 0; s < above.size(); ++s) {
    in_a_row = above[s] ? in_a_row + 1 : 0;
    if (in_a_row == length) return s + 1 - length;
  }
  return std::nullopt;
}

double expected_median(std::size_t dimension) {
  return boost::math::median(boost::math::chi_squared(static_cast<double>(dimension)));
}

// The mean of a chi-square between two quantiles, by x f_d(x) = d f_{d+2}(x).
double expected_trimmed(std::size_t dimension) {
  const auto d = static_cast<double>(dimension);
  const boost::math::chi_squared nees(d), weighted(d + 2.0);
  const double low = boost::math::quantile(nees, kTrimmedShare);
  const double high = boost::math::quantile(nees, 1.0 - kTrimmedShare);
  const double part = boost::math::cdf(weighted, high) - boost::math::cdf(weighted, low);
  return d * part / (1.0 - 2.0 * kTrimmedShare);
}

Consistency judge(const NeesSeries& series, std::span<const double> times, double within) {
  Consistency result;
  result.within = within;
  result.mean = mean_of_finite(series.run_averages);
  result.median = mean_of_finite(series.median);
  result.trimmed = mean_of_finite(series.trimmed);
  count_shares(series, result);
  compare_scans(series, times, result);
  compare_average(series, result);
  result.verdict = verdict_of(result);
  if (result.verdict != Verdict::undecided) result.more_runs.reset();
  return result;
}

std::string in_words(const Consistency& consistency) {
  const std::string exceptions = exceptions_of(consistency);
  switch (consistency.verdict) {
    case Verdict::untested:
      return "not tested" + exceptions;
    case Verdict::consistent:
      return "consistent within " + exact_text(consistency.within) +
             (exceptions.empty() ? "" : " in what can be judged") + exceptions;
    case Verdict::optimistic:
      return "optimistic" + how_far(consistency) + exceptions;
    case Verdict::conservative:
      return "conservative" + how_far(consistency) + exceptions;
    case Verdict::undecided:
      break;
  }
  return what_decides(consistency) + exceptions;
}

namespace {

/// "; ANEES 0.97 to 1.08 times the expected one, 200 runs"
std::string numbers_behind(const Consistency& found) {
  std::string words = "; ";
  if (std::isfinite(found.ratio.lower) && std::isfinite(found.ratio.upper)) {
    words += "ANEES " + compact(found.ratio.lower) + " to " + compact(found.ratio.upper) +
             " times the expected one, ";
  }
  return words + std::to_string(found.runs) + " runs";
}

/// Whether ratios within the margin are left: then more runs may show the filter to be.
bool may_be_within(const Consistency& found) {
  return found.ratio.lower < found.within && found.ratio.upper > 1.0 / found.within;
}

}  // namespace

Gate gate(const Consistency& found, const Allowance& allowed) {
  const std::string numbers = numbers_behind(found);
  const std::string margin = " within " + exact_text(found.within);
  if (found.failed > allowed.failed || found.unusable > allowed.unusable) {
    const bool by_runs = found.failed > allowed.failed;
    return {GateAnswer::inconsistent,
            "not consistent, more " + std::string(by_runs ? "failed runs" : "unusable samples") +
                " than are allowed (" +
                std::to_string(by_runs ? allowed.failed : allowed.unusable) +
                "): " + in_words(found) + numbers};
  }
  switch (found.verdict) {
    case Verdict::untested:
      throw StudyError(
          "no NEES to judge (no complete run, no covariance, or too few effective draws at all "
          "scans): make more runs, have covariance in record.columns, or take more particles");
    case Verdict::consistent:
      return {GateAnswer::consistent, in_words(found) + numbers};
    case Verdict::undecided:
      return {GateAnswer::undecided,
              "not known to be consistent" + margin + ", " + in_words(found) + numbers};
    case Verdict::optimistic:
    case Verdict::conservative:
      break;
  }
  const bool both = may_be_within(found);
  return {GateAnswer::inconsistent, "not consistent, " + in_words(found) +
                                        (both ? ", though it may lie" + margin : "") + numbers};
}

}  // namespace montecarta::analysis
