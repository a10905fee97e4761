// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/whole_run_band.hpp"

#include "engine/errors.hpp"
#include "engine/random/stream.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kMostWalks = 4000, kFewestWalks = 500;
constexpr std::size_t kMostNormals = 16'000'000;
constexpr std::uint32_t kWalks = 0xfffffffeU;  // tells these numbers from those of replicates

std::size_t walks_of(std::size_t scans) {
  return std::clamp(kMostNormals / std::max<std::size_t>(scans, 1), kFewestWalks, kMostWalks);
}

/// For each value, the share of all values that are at least as large.
std::vector<double> shares_not_below(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
  const auto n = static_cast<double>(sorted.size());
  std::vector<double> shares;
  for (const double value : values) {
    const auto below = std::ranges::lower_bound(sorted, value) - sorted.begin();
    shares.push_back((n - static_cast<double>(below)) / n);
  }
  return shares;
}

/// The value of a chi-square divided by its degrees of freedom that lies where `normal` does in a
/// normal distribution (Wilson and Hilferty).
double chi_square_share(double normal, double freedom) {
  const double variance = 2.0 / (9.0 * freedom);
  const double root = std::max(0.0, 1.0 - variance + normal * std::sqrt(variance));
  return root * root * root;
}

double lower_quantile(std::vector<double> values, double share) {
  const auto n = static_cast<double>(values.size());
  const auto place = std::min(values.size() - 1, static_cast<std::size_t>(share * n));
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::ranges::nth_element(values, nth);
  return *nth;
}

}  // namespace

BandWalks::BandWalks(std::size_t scans) : scans_(scans), normals_(walks_of(scans) * scans) {
  for (std::size_t walk = 0; walk * scans_ < normals_.size(); ++walk) {
    RngStream draw(
        {.seed = 0, .run = walk, .step = 0, .index = kWalks, .purpose = Draw::analysis_bootstrap});
    for (std::size_t s = 0; s < scans_; ++s) {
      normals_[walk * scans_ + s] = static_cast<float>(draw.normal());
    }
    of_variance_.push_back(draw.normal());
  }
}

BandWalks::Reach BandWalks::reach(std::size_t walk, std::span<const double> correlation,
                                  std::span<const double> rest) const {
  const float* const normal = normals_.data() + walk * scans_;
  double here = normal[0], greatest = std::abs(here), sum = here;
  for (std::size_t s = 1; s < scans_; ++s) {
    here = correlation[s - 1] * here + rest[s - 1] * static_cast<double>(normal[s]);
    greatest = std::max(greatest, std::abs(here));
    sum += here;
  }
  return {greatest, std::abs(sum) / static_cast<double>(scans_)};
}

WholeRunTest BandWalks::test(std::span<const double> correlation, std::size_t runs,
                             double level) const {
  expect(scans_ > 0 && correlation.size() + 1 == scans_, "a correlation between any two scans");
  std::vector<double> rest;
  for (const double r : correlation) rest.push_back(std::sqrt(1.0 - r * r));
  const std::size_t walks = normals_.size() / scans_;
  std::vector<double> heights, averages;
  double squares = 0.0;
  for (std::size_t walk = 0; walk < walks; ++walk) {
    const Reach found = reach(walk, correlation, rest);
    heights.push_back(found.greatest);
    averages.push_back(found.average);
    squares += found.average * found.average;
  }
  const double variance = squares / static_cast<double>(walks);  // that of one scan is 1
  const double freedom = static_cast<double>(std::max<std::size_t>(runs, 3) - 1);
  for (std::size_t walk = 0; walk < walks; ++walk) {
    const double estimate = variance * chi_square_share(of_variance_[walk], freedom);
    averages[walk] /= std::sqrt(std::min(estimate, 1.0));
  }
  std::vector<double> farther = shares_not_below(heights);
  const std::vector<double> of_averages = shares_not_below(averages);
  std::ranges::transform(farther, of_averages, farther.begin(), std::ranges::min);
  const double each = lower_quantile(std::move(farther), 1.0 - level);
  return {lower_quantile(std::move(heights), 1.0 - each),
          lower_quantile(std::move(averages), 1.0 - each)};
}

}  // namespace montecarta::analysis
