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

/// A normal variable divided by its estimated deviation, which is at most `most` deviations: how
/// often it is farther than a deviate from 0, without the noise of draws.
class StudentisedAverage {
 public:
  /// The estimate has `freedom` degrees of freedom.
  StudentisedAverage(double freedom, double most) {
    for (std::size_t i = 0; i < kNodes; ++i) {
      const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(kNodes);
      const double estimate = std::sqrt(chi_square_share(normal_quantile(share), freedom));
      deviations_.push_back(std::min(estimate, most));
    }
  }
  double beyond(double deviate) const {
    double sum = 0.0;
    for (const double deviation : deviations_) {
      sum += std::erfc(deviate * deviation / std::sqrt(2.0));
    }
    return sum / static_cast<double>(kNodes);
  }
  /// The deviate that it is beyond with this probability.
  double deviate(double probability) const {
    double low = 0.0, high = 1e3;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (low + high);
      (beyond(middle) > probability ? low : high) = middle;
    }
    return high;
  }

 private:
  static constexpr std::size_t kNodes = 256;
  std::vector<double> deviations_;
};

/// The probability of exceeding that the average is given, so that it, or the band with kBandShare
/// of it, rejects with probability `rejected`; what the band adds is counted over walks.
double share_of_average(const std::vector<double>& farther, const std::vector<double>& of_averages,
                        double rejected) {
  double low = 0.0, high = rejected;
  for (int halving = 0; halving < 30; ++halving) {
    const double share = 0.5 * (low + high);
    std::size_t added = 0;
    for (std::size_t walk = 0; walk < farther.size(); ++walk) {
      added += farther[walk] <= kBandShare * share && of_averages[walk] > share ? 1 : 0;
    }
    const double all = share + static_cast<double>(added) / static_cast<double>(farther.size());
    (all > rejected ? high : low) = share;
  }
  return low;
}

double lower_quantile(std::vector<double> values, double share) {
  const auto n = static_cast<double>(values.size());
  const auto place = std::min(values.size() - 1, static_cast<std::size_t>(share * n));
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::ranges::nth_element(values, nth);
  return *nth;
}

/// Of the average of `scans` values that are quadratic in a Gaussian process, whose correlation
/// falls by `correlation` a scan: its skewness divided by that of a gamma of the same variance.
double skew_of_average(std::size_t scans, double correlation) {
  const auto n = static_cast<double>(scans);
  double squares = n, cubes = n, power = 1.0;  // traces of powers of the correlation matrix
  for (std::size_t lag = 1; lag < scans && power > 1e-12; ++lag) {
    const auto l = static_cast<double>(lag);
    power *= correlation;
    squares += 2.0 * (n - l) * power;
    cubes += 6.0 * l * (n - l) * power;
  }
  return cubes * n / (squares * squares);
}

/// Degrees of freedom of the variance of `runs` gamma variables, in units of their mean: their
/// logarithm varies by (2 + 2 c) / runs, c the squared coefficient of variation. Half of c counts,
/// since the tail that matters, of too small variances, is the lighter one; more the more skewed.
double freedom_of(std::size_t runs, double variation, double skew) {
  const auto n = static_cast<double>(std::max<std::size_t>(runs, 3));
  return (n - 1.0) / (1.0 + 0.5 * skew * skew * variation);
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
                             std::size_t dimension, double level) const {
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
  const double variance = std::min(squares / static_cast<double>(walks), 1.0);  // one scan: 1
  double mean = 0.0;
  for (const double r : correlation) mean += r / static_cast<double>(correlation.size());
  const double skew = skew_of_average(scans_, mean);
  const double freedom = freedom_of(runs, variance * 2.0 / static_cast<double>(dimension), skew);
  for (std::size_t walk = 0; walk < walks; ++walk) {
    const double estimate = variance * chi_square_share(of_variance_[walk], freedom);
    averages[walk] /= std::sqrt(std::min(estimate, 1.0));
  }
  const double of_average =
      share_of_average(shares_not_below(heights), shares_not_below(averages), 1.0 - level);
  const StudentisedAverage average(freedom, 1.0 / std::sqrt(variance));
  return {.deviate = lower_quantile(std::move(heights), 1.0 - kBandShare * of_average),
          .average_deviate = average.deviate(of_average),
          .average_level = 1.0 - of_average,
          .average_skew = skew};
}

}  // namespace montecarta::analysis
