// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/along_drive.hpp"

#include "analysis/statistics/correlated_average.hpp"
#include "analysis/verdict/summed_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

namespace montecarta::analysis {
namespace {

/// A smaller ratio is that of errors of 0, or of a deviation that stands for "unknown".
constexpr double kLeastRatio = 1e-60;

/// {component}{scan} These components of `errors` {scan, `dimension`}, at scans that have all.
VectorSeries series_of(std::span<const double> errors, std::size_t dimension,
                       std::span<const std::size_t> components) {
  VectorSeries series(components.size());
  for (std::size_t first = 0; first < errors.size(); first += dimension) {
    const auto row = errors.subspan(first, dimension);
    const auto is_unknown = [&](std::size_t k) { return std::isnan(row[k]); };
    if (std::ranges::any_of(components, is_unknown)) continue;
    for (std::size_t k = 0; k < components.size(); ++k) series[k].push_back(row[components[k]]);
  }
  return series;
}

/// {run}{component}{scan} Likewise, of the runs that have such scans.
std::vector<VectorSeries> drives_of(const ErrorsOfRuns& runs, std::size_t dimension,
                                    std::span<const std::size_t> components) {
  std::vector<VectorSeries> drives;
  for (const std::vector<double>& run : runs) {
    VectorSeries series = series_of(run, dimension, components);
    if (!series.empty() && !series.front().empty()) drives.push_back(std::move(series));
  }
  return drives;
}

/// Components that have an error in every run; the others are known exactly, or never estimated.
std::vector<std::size_t> known_components(const ErrorsOfRuns& runs, std::size_t dimension) {
  std::vector<std::size_t> known;
  for (std::size_t k = 0; k < dimension; ++k) {
    const std::array one = {k};
    if (!runs.empty() && drives_of(runs, dimension, one).size() == runs.size()) known.push_back(k);
  }
  return known;
}

/// The mean over drives of the mean square of all components.
double ratio_of(const std::vector<VectorSeries>& drives) {
  double ratio = 0.0;
  for (const VectorSeries& drive : drives) {
    double sum = 0.0;
    for (const std::vector<double>& component : drive) {
      for (const double error : component) sum += error * error;
    }
    ratio += sum / static_cast<double>(drive.size() * drive.front().size() * drives.size());
  }
  return ratio;
}

void add_test(Family family, std::string name, std::vector<VectorSeries> drives,
              std::vector<MemberTest>& all) {
  if (drives.empty()) return;
  const double ratio = ratio_of(drives);
  if (ratio < kLeastRatio) return;
  Member member{.name = std::move(name), .estimate = ratio, .p = p_value_of_one(drives)};
  all.push_back({family, std::move(member), [drives = std::move(drives)](double level) {
                   return correlated_average(drives, level).ratio;
                 }});
}

/// Scans of all runs in [first, end), of which the components in [from, to) are judged.
struct JudgedPart {
  std::size_t first = 0, end = 0, from = 0, to = 0;
};

/// The test of the mean square of errors {run}{scan, `dimension`} that are independent from scan to
/// scan: a chi-square variable, of fewer degrees of freedom if the squares vary more than those of
/// Gaussian errors. Returns how much more they do, which is taken to be `least_more` at least.
double add_white_test(Family family, Member member, const ErrorsOfRuns& runs, std::size_t dimension,
                      const JudgedPart& part, double least_more, std::vector<MemberTest>& all) {
  std::vector<double> sums, counts;
  double sum = 0.0, count = 0.0;
  for (const std::vector<double>& run : runs) {
    for (std::size_t s = part.first; s < std::min(part.end, run.size() / dimension); ++s) {
      double of_scan = 0.0, components = 0.0;
      for (std::size_t k = s * dimension + part.from; k < s * dimension + part.to; ++k) {
        if (std::isnan(run[k])) continue;
        of_scan += run[k] * run[k];
        components += 1.0;
      }
      sums.push_back(of_scan);
      counts.push_back(components);
      sum += of_scan;
      count += components;
    }
  }
  const double ratio = sum / count;
  if (!(ratio >= kLeastRatio)) return least_more;
  double squares = 0.0;
  for (std::size_t s = 0; s < sums.size(); ++s) {
    squares += std::pow(sums[s] / ratio - counts[s], 2);
  }
  member.estimate = ratio;
  const double more_than_gaussian = std::max(least_more, squares / (2.0 * count));
  all.push_back(chi_squared_test(family, std::move(member), count / more_than_gaussian));
  return more_than_gaussian;
}

}  // namespace

void AlongDrive::add(const WhitenedRun& run) {
  dimension_ = run.dimension;
  ++runs_;
  forget_if_enough();
  if (runs_ >= kFewestRunsOfAPlan) return;
  whitened_.push_back(run.whitened);
  standardised_.push_back(run.standardised);
}

void AlongDrive::merge(AlongDrive& next) {
  dimension_ = std::max(dimension_, next.dimension_);
  runs_ += next.runs_;
  std::ranges::move(next.whitened_, std::back_inserter(whitened_));
  std::ranges::move(next.standardised_, std::back_inserter(standardised_));
  forget_if_enough();
}

void AlongDrive::forget_if_enough() {
  if (runs_ < kFewestRunsOfAPlan) return;
  whitened_.clear();
  standardised_.clear();
}

bool AlongDrive::have_short_memory() const {
  constexpr double kLeastScans = 10.0;
  const auto drives = drives_of(whitened_, dimension_, known_components(whitened_, dimension_));
  if (drives.empty() || ratio_of(drives) < kLeastRatio) return false;
  return correlated_average(drives, kUsualLevel).effective_samples >=
         kLeastScans * static_cast<double>(drives.size());
}

std::vector<MemberTest> AlongDrive::tests(std::span<const std::string> components) const {
  std::vector<MemberTest> all;
  add_test(Family::size, "",
           drives_of(whitened_, dimension_, known_components(whitened_, dimension_)), all);
  for (std::size_t k = 0; dimension_ > 1 && k < dimension_; ++k) {
    const std::array one = {k};
    add_test(Family::component, components[k], drives_of(standardised_, dimension_, one), all);
  }
  return all;
}

std::vector<MemberTest> AlongDrive::white_tests(std::span<const std::string> components,
                                                std::span<const std::size_t> ends,
                                                std::span<const Member> stretches) const {
  std::vector<MemberTest> all;
  if (dimension_ == 0 || ends.empty()) return all;
  const JudgedPart whole{0, ends.back(), 0, dimension_};
  // A stretch is short, and its own squares may not show how they vary.
  const double of_whole = add_white_test(Family::size, {}, whitened_, dimension_, whole, 1.0, all);
  for (std::size_t k = 0; dimension_ > 1 && k < dimension_; ++k) {
    add_white_test(Family::component, {.name = components[k]}, standardised_, dimension_,
                   {0, ends.back(), k, k + 1}, 1.0, all);
  }
  for (std::size_t s = 0; s < stretches.size(); ++s) {
    add_white_test(Family::stretch, stretches[s], whitened_, dimension_,
                   {s == 0 ? 0 : ends[s - 1], ends[s], 0, dimension_}, of_whole, all);
  }
  return all;
}

}  // namespace montecarta::analysis
