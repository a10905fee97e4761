// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/summed_error.hpp"

#include "analysis/statistics/distributions.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

namespace montecarta::analysis {

std::vector<std::size_t> ends_of_stretches(std::size_t scans) {
  const std::size_t stretches = scans < 2 * kStretches ? 1 : kStretches;
  std::vector<std::size_t> ends;
  for (std::size_t s = 1; s <= stretches; ++s) ends.push_back(s * scans / stretches);
  return ends;
}

namespace {

/// The law of the mean of `freedom` squares of independent standard normal variables. Results are
/// kept, since `freedom` is nearly always the same.
class ChiSquareLaw {
 public:
  /// Two-sided p-value of a mean.
  static double p_value(double freedom, double mean) {
    const double sum = freedom * mean;
    return std::min(1.0,
                    2.0 * std::min(chi_squared_cdf(sum, freedom), chi_squared_tail(sum, freedom)));
  }
  /// Interval that holds the true ratio of a mean.
  Interval interval(double freedom, double mean, double level) {
    const auto [found, is_new] = bounds_.try_emplace({freedom, level});
    if (is_new) {
      const double tail = 0.5 * (1.0 - level);
      found->second = {chi_squared_quantile(tail, freedom) / freedom,
                       chi_squared_beyond(tail, freedom) / freedom};
    }
    return {mean / found->second.upper, mean / found->second.lower};
  }

 private:
  std::map<std::pair<double, double>, Interval> bounds_;
};

MemberTest exact_test(Family family, Member member, double freedom,
                      const std::shared_ptr<ChiSquareLaw>& law) {
  const double ratio = member.estimate;
  member.p = ChiSquareLaw::p_value(freedom, ratio);
  return {family, std::move(member),
          [law, freedom, ratio](double level) { return law->interval(freedom, ratio, level); }};
}

/// A scan is off if neither the exact law of Gaussian errors nor the variation between runs
/// explains its ratio: the runs do not show the tails of errors, and the exact law holds only for
/// Gaussian ones. Fewer than three runs show no variation.
MemberTest with_runs(MemberTest exact, const RunMean& runs, std::size_t n) {
  if (n < kFewestJudgedRuns) return exact;
  exact.member.p = std::max(exact.member.p, runs.p_value(1.0));
  exact.interval = [law = std::move(exact.interval), runs](double level) {
    const Interval gaussian = law(level), by_runs = runs.interval(level);
    return Interval{std::min(gaussian.lower, by_runs.lower),
                    std::max(gaussian.upper, by_runs.upper)};
  };
  return exact;
}

}  // namespace

MemberTest ratio_test(Family family, Member member, const RunMean& ratio) {
  member.estimate = ratio.mean();
  member.p = ratio.p_value(1.0);
  return {family, std::move(member), [ratio](double level) { return ratio.interval(level); }};
}

MemberTest chi_squared_test(Family family, Member member, double freedom) {
  return exact_test(family, std::move(member), freedom, std::make_shared<ChiSquareLaw>());
}

void SummedError::add(std::span<const double> nees, double dimension) {
  add(nees, std::vector<double>(nees.size(), dimension));
}

void SummedError::add(std::span<const double> nees, std::span<const double> dimensions) {
  expect(nees.size() <= scans_.size() && dimensions.size() == nees.size(), "a NEES for each scan");
  double sum = 0.0, expected = 0.0;
  for (std::size_t s = 0; s < nees.size(); ++s) {
    if (std::isnan(nees[s])) continue;
    scans_[s].nees += nees[s];
    scans_[s].dimensions += dimensions[s];
    scans_[s].runs.add(nees[s] / dimensions[s]);
    sum += nees[s];
    expected += dimensions[s];
  }
  if (expected > 0.0) ratios_.add(sum / expected);
}

double SummedError::common_skewness() const {
  double cubes = 0.0, squares = 0.0, n = 0.0;
  for (const Scan& scan : scans_) {
    const Summary runs = scan.runs.result();
    if (!(runs.sd > 0.0) || std::isnan(runs.skewness)) continue;
    // Relative, so that scans of any size have equal weight.
    const double deviation = runs.sd / runs.mean;
    cubes += runs.skewness * deviation * deviation * deviation;
    squares += deviation * deviation;
    n += 1.0;
  }
  return n > 0.0 ? cubes / n / std::pow(squares / n, 1.5) : 0.0;
}

bool SummedError::is_rounded_away(const Scan& scan) const {
  return scan.nees == 0.0 && scan.n() < static_cast<double>(kFewestRunsOfAPlan) &&
         ratios().mean > 0.0;
}

std::vector<MemberTest> SummedError::scan_tests(std::span<const double> times) const {
  std::vector<MemberTest> all;
  const auto law = std::make_shared<ChiSquareLaw>();
  const double skewness = common_skewness();
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    const Scan& scan = scans_[s];
    if (!(scan.dimensions > 0.0) || is_rounded_away(scan)) continue;
    const Summary runs = scan.runs.result();
    Member member{
        .from = times[s], .to = times[s], .origin = origin_of(times), .estimate = scan.ratio()};
    all.push_back(with_runs(exact_test(Family::scan, std::move(member), scan.dimensions, law),
                            RunMean::of_ratio(runs, skewness), runs.n));
  }
  return all;
}

MemberTest SummedError::size_test() const {
  return ratio_test(Family::size, {.name = "all"}, RunMean::of_ratio(ratios()));
}

std::vector<FamilyTest> SummedError::families(double level, std::span<const double> times) const {
  std::vector<MemberTest> all = scan_tests(times);
  if (ratios().n >= kFewestJudgedRuns) all.push_back(size_test());
  return judge_tests(std::move(all), level);
}

std::vector<FamilyTest> SummedError::white_families(
    double level, std::span<const double> times, std::span<const SpreadOfSquares> spreads) const {
  std::vector<MemberTest> all = scan_tests(times);
  const std::vector<std::size_t> ends = ends_of_stretches(scans_.size());
  expect(spreads.size() == ends.size(), "the spread of each stretch");
  const auto law = std::make_shared<ChiSquareLaw>();
  double of_whole = 1.0;  // a stretch is short, and its own squares may not show how they vary
  const auto add_sum = [&](Family family, Member member, std::size_t first, std::size_t end,
                           const SpreadOfSquares& spread) {
    double nees = 0.0, dimensions = 0.0;
    for (std::size_t s = first; s < end; ++s) {
      nees += scans_[s].nees;
      dimensions += scans_[s].dimensions;
    }
    if (!(dimensions > 0.0)) return 1.0;
    member.estimate = nees / dimensions;
    const double own = nees > 0.0 ? spread.more_than_gaussian(member.estimate, dimensions) : 1.0;
    all.push_back(exact_test(family, std::move(member), dimensions / std::max(own, of_whole), law));
    return own;
  };
  SpreadOfSquares whole;
  for (const SpreadOfSquares& spread : spreads) whole.add(spread);
  of_whole = add_sum(Family::size, {.name = "all"}, 0, scans_.size(), whole);
  for (std::size_t k = 0; k < ends.size() && ends.size() > 1; ++k) {
    const std::size_t first = k == 0 ? 0 : ends[k - 1];
    add_sum(Family::stretch,
            {.from = times[first], .to = times[ends[k] - 1], .origin = origin_of(times)}, first,
            ends[k], spreads[k]);
  }
  return judge_tests(std::move(all), level);
}

}  // namespace montecarta::analysis
