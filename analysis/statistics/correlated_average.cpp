// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/correlated_average.hpp"

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/statistics/symmetric_eigen.hpp"
#include "engine/errors.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

namespace montecarta::analysis {
namespace {

// All lags up to this one are evaluated, longer ones in growing steps.
constexpr std::size_t kEveryLag = 128;
constexpr double kLagGrowth = 1.05;
constexpr double kWindow = 5.0;
// Least squared correlation that counts, in units of its mean by chance.
constexpr double kChanceFactor = 4.0;

/// {lag} `of(lag)`, evaluated at few lags and linear in between, so that a long series costs n log
/// n.
template <class Function>
std::vector<double> at_all_lags(std::size_t samples, const Function& of) {
  std::vector<double> values(samples);
  std::size_t last = 0;
  for (std::size_t lag = 1; lag < samples;) {
    values[lag] = of(lag);
    for (std::size_t h = last + 1; h < lag; ++h) {
      const double share = static_cast<double>(h - last) / static_cast<double>(lag - last);
      values[h] = std::lerp(values[last], values[lag], share);
    }
    last = lag;
    const auto grown = static_cast<std::size_t>(kLagGrowth * static_cast<double>(lag));
    const std::size_t next = lag < kEveryLag ? lag + 1 : std::max(lag + 1, grown);
    lag = lag + 1 < samples ? std::min(next, samples - 1) : samples;
  }
  return values;
}

double product_at(const std::vector<double>& a, const std::vector<double>& b, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t t = lag; t < a.size(); ++t) sum += a[t] * b[t - lag];
  return sum / static_cast<double>(a.size() - lag);
}

}  // namespace

std::vector<double> squared_correlations(const VectorSeries& series) {
  const std::size_t n = series.front().size();
  double power = 0.0;  // sum of the mean squares
  for (const auto& component : series) power += product_at(component, component, 0);
  const auto d = static_cast<double>(series.size());
  const double unit = power * power / d;
  if (!(unit > 0.0)) return std::vector<double>(n, 1.0);
  std::vector<double> squares = at_all_lags(n, [&](std::size_t lag) {
    double sum = 0.0;
    for (const auto& a : series) sum += std::pow(product_at(a, a, lag), 2);
    return std::min(sum / unit, 1.0);
  });
  squares.front() = 1.0;
  // Mean at lag 0 of the squared correlation between two components that are independent.
  const double by_chance = unit / d / effective_samples(squares);
  const std::vector<double> between = at_all_lags(n, [&](std::size_t lag) {
    const double least =
        kChanceFactor * by_chance * static_cast<double>(n) / static_cast<double>(n - lag);
    double sum = 0.0;
    for (const auto& a : series) {
      for (const auto& b : series) {
        const double square = &a == &b ? 0.0 : std::pow(product_at(a, b, lag), 2);
        sum += square > least ? square : 0.0;
      }
    }
    return sum / unit;
  });
  for (std::size_t lag = 1; lag < n; ++lag) {
    squares[lag] = std::min(squares[lag] + between[lag], 1.0);
  }
  return squares;
}

VectorSeries semivariances(const VectorSeries& series) {
  VectorSeries all;
  for (const auto& component : series) {
    all.push_back(at_all_lags(component.size(), [&](std::size_t lag) {
      double sum = 0.0;
      for (std::size_t t = lag; t < component.size(); ++t) {
        const double step = component[t] - component[t - lag];
        sum += step * step;
      }
      return 0.5 * sum / static_cast<double>(component.size() - lag);
    }));
  }
  return all;
}

double effective_samples(std::span<const double> squared_correlations) {
  const auto n = static_cast<double>(squared_correlations.size());
  double sum = 1.0;
  for (std::size_t lag = 1; lag < squared_correlations.size(); ++lag) {
    const auto h = static_cast<double>(lag);
    sum += 2.0 * (1.0 - h / n) * squared_correlations[lag];
    if (h >= kWindow * sum) break;
  }
  return std::max(n / sum, 1.0);
}

namespace {

constexpr int kHalvings = 60;
// [normal deviates] nearer to the mean, the formula loses its digits.
constexpr double kAtTheMean = 1e-4;

/// Derivatives of the cumulant generating function at `t`.
struct Cumulants {
  double value = 0.0, first = 0.0, second = 0.0, third = 0.0;
};

Cumulants cumulants_at(std::span<const WeightedSquares> terms, double t) {
  Cumulants sums;
  for (const auto& [weight, count] : terms) {
    const double scaled = weight / (1.0 - 2.0 * t * weight);
    sums.value -= 0.5 * count * std::log1p(-2.0 * t * weight);
    sums.first += count * scaled;
    sums.second += 2.0 * count * scaled * scaled;
    sums.third += 8.0 * count * scaled * scaled * scaled;
  }
  return sums;
}

/// The `t` at which the first derivative, which increases, is `x`.
double saddlepoint(std::span<const WeightedSquares> terms, double x) {
  const double mean = cumulants_at(terms, 0.0).first;
  double below = 0.0, above = 0.0;
  if (x < mean) {
    below = -1.0 / mean;
    while (cumulants_at(terms, below).first > x) below *= 2.0;
  } else {
    above = 0.5 * (1.0 - 1e-12) / std::ranges::max(terms, {}, &WeightedSquares::weight).weight;
  }
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (below + above);
    (cumulants_at(terms, middle).first < x ? below : above) = middle;
  }
  return 0.5 * (below + above);
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Number of blocks of a series, between which correlation is resolved.
constexpr std::size_t kBlocks = 24;
constexpr double kFarthestRatio = 1e9;  // beyond this ratio an interval has no upper end
constexpr double kMostEffective = 1e9;
constexpr double kEndAccuracy = 1e-4;  // relative accuracy of the end of an interval

/// Law of the mean square of n correlated samples of one component, as a sum of independent
/// squares. Samples have the `semivariance` {lag}; their covariance at a lag is `variance` minus
/// the semivariance.
class ComponentLaw {
 public:
  ComponentLaw(const std::vector<double>& semivariance, double variance) : variance_(variance) {
    for (const double value : semivariance) covariance_.push_back(std::max(variance - value, 0.0));
    covariance_.front() = variance;
  }

  /// Adds the squares to `terms`, with weights divided by `dimension`.
  void add_to(std::vector<WeightedSquares>& terms, double dimension) const {
    const Eigen::VectorXd slow = symmetric_eigenvalues(between_blocks()).cwiseMax(0.0);
    for (const double weight : slow) terms.push_back({weight / dimension, 1.0});
    // The remaining variance lies within the blocks. It gets equal weights that have its sum and
    // its sum of squares.
    const auto n = static_cast<double>(covariance_.size());
    const double rest = variance_ - slow.sum();
    if (rest <= 1e-12 * variance_) return;
    const double squares = std::max(sum_of_squares() - slow.squaredNorm(), rest * rest / n);
    terms.push_back({squares / rest / dimension, rest * rest / squares});
  }

 private:
  /// Sum of the squares of all eigenvalues of the covariance of the samples, divided by n.
  double sum_of_squares() const {
    const auto n = static_cast<double>(covariance_.size());
    double sum = covariance_.front() * covariance_.front();
    for (std::size_t lag = 1; lag < covariance_.size(); ++lag) {
      sum += 2.0 * (1.0 - static_cast<double>(lag) / n) * covariance_[lag] * covariance_[lag];
    }
    return sum / n;
  }

  /// Covariance of the means of two blocks of `length` samples that are `apart` blocks apart.
  double covariance_at(std::size_t apart, double length) const {
    const double middle = static_cast<double>(apart) * length;
    const auto first = static_cast<std::size_t>(std::max(std::ceil(middle - length), 0.0));
    double sum = 0.0, weights = 0.0;
    for (std::size_t lag = first; lag < covariance_.size(); ++lag) {
      const double distance = std::abs(static_cast<double>(lag) - middle) / length;
      if (static_cast<double>(lag) >= middle + length) break;
      const double weight = (1.0 - distance) * (apart == 0 && lag > 0 ? 2.0 : 1.0);
      sum += weight * covariance_[lag];
      weights += weight;
    }
    return sum / weights;
  }

  Eigen::MatrixXd between_blocks() const {
    const std::size_t blocks = std::min(kBlocks, covariance_.size());
    const auto count = static_cast<double>(blocks);
    std::vector<double> at(blocks);
    for (std::size_t k = 0; k < blocks; ++k) {
      at[k] = covariance_at(k, static_cast<double>(covariance_.size()) / count) / count;
    }
    const auto side = static_cast<Eigen::Index>(blocks);
    return Eigen::MatrixXd::NullaryExpr(side, side, [&](Eigen::Index i, Eigen::Index j) {
      return at[static_cast<std::size_t>(std::abs(i - j))];
    });
  }

  double variance_;
  std::vector<double> covariance_;  ///< {lag} covariance of the samples
};

/// Probability that the mean of the averages of drives with an expected ratio of `ratio` is at most
/// `mean`, if the part of the errors that their variograms do not show lasts for a whole drive.
double probability_of_less(const std::vector<VectorSeries>& variograms, double mean, double ratio) {
  std::vector<WeightedSquares> terms;
  for (const VectorSeries& variogram : variograms) {
    const auto parts = static_cast<double>(variogram.size() * variograms.size());
    for (const auto& semivariance : variogram) {
      ComponentLaw(semivariance, ratio).add_to(terms, parts);
    }
  }
  return probability_below(terms, mean);
}

/// The ratio, at least `mean`, at which the decreasing `probability` equals `tail`.
double ratio_where(const std::function<double(double)>& probability, double tail, double mean) {
  double below = mean, above = 2.0 * mean;
  while (probability(above) > tail) {
    below = above;
    above *= 2.0;
    if (above > kFarthestRatio * mean) return kInfinity;
  }
  while (above > (1.0 + kEndAccuracy) * below) {
    const double middle = std::sqrt(below * above);
    (probability(middle) > tail ? below : above) = middle;
  }
  return above;
}

/// Upper bound of a consistent filter's average with this number of degrees of freedom, divided by
/// its expectation.
double largest_by_chance(double freedom, double tail) {
  return chi_squared_beyond(tail, freedom) / freedom;
}

/// Average of the squares, and variance of the squares in units of the squared average.
struct SquareMoments {
  double mean = 0.0, variation = 0.0;
};

SquareMoments moments_of_nees(const VectorSeries& errors) {
  const std::size_t n = errors.front().size();
  std::vector<double> nees(n);
  for (const auto& component : errors) {
    for (std::size_t t = 0; t < n; ++t) nees[t] += component[t] * component[t];
  }
  const auto count = static_cast<double>(n);
  const double mean = std::accumulate(nees.begin(), nees.end(), 0.0) / count;
  double squares = 0.0;
  for (const double value : nees) squares += (value - mean) * (value - mean);
  return {mean, mean > 0.0 ? squares / count / (mean * mean) : 0.0};
}

/// Effective samples of the errors. There are fewer if the squares vary more than 2 / d, as those
/// of errors with a few outliers do.
double effective_samples_of(const VectorSeries& errors, const SquareMoments& nees) {
  const auto d = static_cast<double>(errors.size());
  const double gaussian = nees.variation > 2.0 / d ? 2.0 / d / nees.variation : 1.0;
  return std::max(effective_samples(squared_correlations(errors)) * gaussian, 1.0);
}

/// Ratio of the ends of the interval for a series with this number of independent samples, whose
/// average is 1.
double end_ratio(double samples, double d, double tail) {
  const auto probability = [&](double ratio) {
    const std::array<WeightedSquares, 2> terms = {
        {{(ratio - 1.0 + 1.0 / samples) / d, d}, {1.0 / (samples * d), d * (samples - 1.0)}}};
    return probability_below(terms, 1.0);
  };
  return ratio_where(probability, tail, 1.0) * largest_by_chance(d * samples, tail);
}

/// The average of the drives without its interval.
CorrelatedAverage average_of(std::span<const VectorSeries> drives) {
  expect(!drives.empty() && !drives.front().empty() && !drives.front().front().empty(),
         "there is a drive, and a series has components and samples");
  const auto d = static_cast<double>(drives.front().size());
  const auto count = static_cast<double>(drives.size());
  CorrelatedAverage result;
  double inverse = 0.0;  // sum over drives of 1 / effective samples
  for (const VectorSeries& errors : drives) {
    const SquareMoments nees = moments_of_nees(errors);
    result.mean += nees.mean / d / count;
    inverse += 1.0 / effective_samples_of(errors, nees);
  }
  result.effective_samples = count * count / inverse;
  return result;
}

/// {drive} Semivariances of the errors.
std::vector<VectorSeries> variograms_of(std::span<const VectorSeries> drives) {
  std::vector<VectorSeries> variograms;
  for (const VectorSeries& errors : drives) variograms.push_back(semivariances(errors));
  return variograms;
}

}  // namespace

double probability_below(std::span<const WeightedSquares> terms, double x) {
  if (!(x > 0.0)) return 0.0;
  const double t = saddlepoint(terms, x);
  const Cumulants at = cumulants_at(terms, t);
  const double v = t * std::sqrt(at.second);
  if (std::abs(v) < kAtTheMean) {
    return normal_cdf(at.third / (6.0 * std::pow(at.second, 1.5)));
  }
  const double w = std::copysign(std::sqrt(std::max(2.0 * (t * x - at.value), 0.0)), t);
  return normal_cdf(w + std::log(v / w) / w);
}

CorrelatedAverage correlated_average(const VectorSeries& errors, double level) {
  return correlated_average(std::span(&errors, 1), level);
}

CorrelatedAverage correlated_average(std::span<const VectorSeries> drives, double level) {
  nees_bounds(1, 1, level);  // throws if the level is wrong
  const double tail = 0.5 * (1.0 - level);
  CorrelatedAverage result = average_of(drives);
  if (result.mean == 0.0) return result;
  const auto d = static_cast<double>(drives.front().size());
  const std::vector<VectorSeries> variograms = variograms_of(drives);
  const auto probability = [&](double ratio) {
    return probability_of_less(variograms, result.mean, ratio);
  };
  result.ratio = {result.mean / largest_by_chance(d * result.effective_samples, tail),
                  ratio_where(probability, tail, result.mean)};
  return result;
}

double p_value_of_one(std::span<const VectorSeries> drives) {
  const CorrelatedAverage found = average_of(drives);
  if (found.mean == 0.0) return 1.0;
  const double freedom = static_cast<double>(drives.front().size()) * found.effective_samples;
  const double tail = found.mean >= 1.0
                          ? chi_squared_tail(found.mean * freedom, freedom)
                          : probability_of_less(variograms_of(drives), found.mean, 1.0);
  return std::min(1.0, 2.0 * tail);
}

double samples_that_decide(std::size_t dimension, double level, double within) {
  const double tail = 0.5 * (1.0 - level);
  const auto d = static_cast<double>(dimension);
  const auto decide = [&](double samples) { return end_ratio(samples, d, tail) <= within; };
  if (!decide(kMostEffective)) return kInfinity;
  double too_few = 1.0, enough = kMostEffective;
  while (enough > 1.01 * too_few) {
    const double middle = std::sqrt(too_few * enough);
    (decide(middle) ? enough : too_few) = middle;
  }
  return enough;
}

}  // namespace montecarta::analysis
