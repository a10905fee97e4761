// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/along_drive.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace montecarta::analysis {
namespace {

/// {component}{scan} The rows of `errors` {scan, component} without NaN.
VectorSeries complete_rows(std::span<const double> errors, std::size_t dimension) {
  VectorSeries series(dimension);
  for (std::size_t first = 0; first < errors.size(); first += dimension) {
    const auto row = errors.subspan(first, dimension);
    if (std::ranges::any_of(row, [](double e) { return std::isnan(e); })) continue;
    for (std::size_t k = 0; k < dimension; ++k) series[k].push_back(row[k]);
  }
  return series;
}

/// {scan} Component `k` of `errors` {scan, component} without NaN.
std::vector<double> known(std::span<const double> errors, std::size_t k, std::size_t dimension) {
  std::vector<double> series;
  for (std::size_t i = k; i < errors.size(); i += dimension) {
    if (!std::isnan(errors[i])) series.push_back(errors[i]);
  }
  return series;
}

MemberTest test_of(Family family, std::string name, std::vector<VectorSeries> drives) {
  const CorrelatedAverage found = correlated_average(drives, kUsualLevel);
  return {family,
          {.name = std::move(name), .estimate = found.mean, .p = p_value_of_one(drives)},
          [drives = std::move(drives)](double level) {
            return correlated_average(drives, level).ratio;
          }};
}

}  // namespace

void AlongDrive::add(const WhitenedRun& run) {
  ++runs_;
  forget_if_enough();
  if (runs_ >= kFewestJudgedRuns) return;
  standardised_.resize(run.dimension);
  for (std::size_t k = 0; k < run.dimension; ++k) {
    standardised_[k].push_back(known(run.standardised, k, run.dimension));
  }
  whitened_.push_back(complete_rows(run.whitened, run.dimension));
}

void AlongDrive::merge(AlongDrive& next) {
  runs_ += next.runs_;
  std::ranges::move(next.whitened_, std::back_inserter(whitened_));
  standardised_.resize(std::max(standardised_.size(), next.standardised_.size()));
  for (std::size_t k = 0; k < next.standardised_.size(); ++k) {
    std::ranges::move(next.standardised_[k], std::back_inserter(standardised_[k]));
  }
  forget_if_enough();
}

void AlongDrive::forget_if_enough() {
  if (runs_ < kFewestJudgedRuns) return;
  whitened_.clear();
  standardised_.clear();
}

std::vector<MemberTest> AlongDrive::tests(std::span<const std::string> components) const {
  const auto has_errors = [](const VectorSeries& drive) { return !drive.front().empty(); };
  std::vector<MemberTest> all;
  std::vector<VectorSeries> drives;
  std::ranges::copy_if(whitened_, std::back_inserter(drives), has_errors);
  if (!drives.empty()) all.push_back(test_of(Family::size, "", std::move(drives)));
  for (std::size_t k = 0; standardised_.size() > 1 && k < standardised_.size(); ++k) {
    std::vector<VectorSeries> of_component;
    for (const std::vector<double>& run : standardised_[k]) {
      if (!run.empty()) of_component.push_back({run});
    }
    if (of_component.empty()) continue;
    all.push_back(test_of(Family::component, components[k], std::move(of_component)));
  }
  return all;
}

double AlongDrive::length_that_decides(double level, double within) const {
  if (whitened_.empty() || whitened_.front().front().empty()) return kNaN;
  const CorrelatedAverage found = correlated_average(whitened_.front(), level);
  return samples_that_decide(whitened_.front().size(), level, within) / found.effective_samples;
}

}  // namespace montecarta::analysis
