// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/summed_error.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

namespace montecarta::analysis {
namespace {

/// Laws of the ratio of single scans by their degrees of freedom, which are nearly always the same.
class ScanLaws {
 public:
  double p_value(double freedom, double ratio) { return law(freedom).p_value(ratio); }
  Interval interval(double freedom, double ratio, double level) {
    const auto [found, is_new] = intervals_.try_emplace({freedom, level});
    if (is_new) found->second = law(freedom).interval(1.0, level);
    return {ratio * found->second.lower, ratio * found->second.upper};
  }

 private:
  /// The exact law: so many squares of independent standard normal variables.
  const SquaresLaw& law(double freedom) {
    return laws_.try_emplace(freedom, Traces{1.0, 1.0, 1.0}, freedom).first->second;
  }

  std::map<double, SquaresLaw> laws_;
  std::map<std::pair<double, double>, Interval> intervals_;
};

}  // namespace

void SummedError::add(std::size_t scan, double nees, double dimension) {
  if (std::isnan(nees)) return;
  scans_[scan].nees += nees;
  scans_[scan].dimensions += dimension;
  scans_[scan].runs += 1.0;
}

std::vector<MemberTest> SummedError::scan_tests(std::span<const double> times) const {
  std::vector<MemberTest> all;
  const auto laws = std::make_shared<ScanLaws>();
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    const double freedom = scans_[s].dimensions;
    if (!(freedom > 0.0)) continue;
    const double ratio = scans_[s].ratio();
    Member member{.from = times[s], .to = times[s], .estimate = ratio};
    member.p = laws->p_value(freedom, ratio);
    all.push_back({Family::scan, std::move(member), [laws, freedom, ratio](double level) {
                     return laws->interval(freedom, ratio, level);
                   }});
  }
  return all;
}

double SummedError::most_runs() const {
  double most = 0.0;
  for (const Scan& scan : scans_) most = std::max(most, scan.runs);
  return most;
}

MemberTest SummedError::size_test() const {
  const Scan sum = sum_of(0, scans_.size());
  const double runs = most_runs();
  double deviation = 0.0;  // of a run's sum, over the square root of 2
  for (const Scan& scan : scans_) {
    if (scan.runs > 0.0) deviation += std::sqrt(scan.dimensions / scan.runs);
  }
  const SquaresLaw law(traces_of_constant_errors(sum.dimensions / runs, deviation * deviation),
                       runs);
  return ratio_test(Family::size, {.name = "NEES", .estimate = sum.ratio()}, law);
}

std::vector<FamilyTest> SummedError::families(double level, std::span<const double> times) const {
  if (!(most_runs() > 0.0)) return {};
  std::vector<MemberTest> all = scan_tests(times);
  all.push_back(size_test());
  return judge_tests(std::move(all), level);
}

SummedError::Scan SummedError::sum_of(std::size_t first, std::size_t end) const {
  Scan sum;
  for (std::size_t s = first; s < end; ++s) {
    sum.nees += scans_[s].nees;
    sum.dimensions += scans_[s].dimensions;
  }
  return sum;
}

std::vector<FamilyTest> SummedError::white_families(double level,
                                                    std::span<const double> times) const {
  std::vector<MemberTest> all = scan_tests(times);
  const auto add_sum = [&](Family family, Member member, std::size_t first, std::size_t end) {
    const Scan sum = sum_of(first, end);
    if (!(sum.dimensions > 0.0)) return;
    member.estimate = sum.ratio();
    const SquaresLaw law({1.0, 1.0, 1.0}, sum.dimensions);
    all.push_back(ratio_test(family, std::move(member), law));
  };
  add_sum(Family::size, {.name = "all"}, 0, scans_.size());
  const std::size_t stretches = scans_.size() < 2 * kStretches ? 0 : kStretches;
  for (std::size_t k = 0; k < stretches; ++k) {
    const std::size_t first = k * scans_.size() / stretches;
    const std::size_t end = (k + 1) * scans_.size() / stretches;
    add_sum(Family::stretch, {.from = times[first], .to = times[end - 1]}, first, end);
  }
  return judge_tests(std::move(all), level);
}

}  // namespace montecarta::analysis
