// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/squares_law.hpp"

#include "analysis/statistics/distributions.hpp"
#include "engine/errors.hpp"
#include "engine/numbers/lanes.hpp"

#include <boost/math/special_functions/gamma.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kLanes = engine::Lanes::kSize;  // sums of a product, added in a fixed order
constexpr double kFarthestScore = 37;                 // the normal law has no double beyond
constexpr double kFewestDegrees = 2.0;

double total(const engine::Lanes& sums) {
  std::array<double, kLanes> each{};
  sums.store_unaligned(each.data());
  return ((each[0] + each[4]) + (each[2] + each[6])) + ((each[1] + each[5]) + (each[3] + each[7]));
}

/// Scalar products of `row` with four others, all of the same `length`, a multiple of kLanes.
std::array<double, 4> products_with_four(const double* row, std::array<const double*, 4> others,
                                         std::size_t length) {
  engine::Lanes a(0.0), b(0.0), c(0.0), d(0.0);
  for (std::size_t k = 0; k < length; k += kLanes) {
    const engine::Lanes here = engine::Lanes::load_unaligned(row + k);
    a += here * engine::Lanes::load_unaligned(others[0] + k);
    b += here * engine::Lanes::load_unaligned(others[1] + k);
    c += here * engine::Lanes::load_unaligned(others[2] + k);
    d += here * engine::Lanes::load_unaligned(others[3] + k);
  }
  return {total(a), total(b), total(c), total(d)};
}

std::vector<double> padded(std::span<const double> rows, std::size_t runs, std::size_t length,
                           std::size_t width) {
  std::vector<double> all(runs * width);
  for (std::size_t i = 0; i < runs; ++i) {
    std::ranges::copy(rows.subspan(i * length, length),
                      all.begin() + static_cast<std::ptrdiff_t>(i * width));
  }
  return all;
}

/// The normal score with the given probability of its upper or lower tail, whichever is smaller.
double score_of_tails(double lower, double upper) {
  const double tail = std::min(lower, upper);
  const double score = tail > 0.0 ? -normal_quantile(tail) : kFarthestScore;
  return lower < upper ? -std::min(score, kFarthestScore) : std::min(score, kFarthestScore);
}

}  // namespace

void RunProducts::add(std::span<const double> rows, std::size_t length) {
  expect(rows.size() == runs_ * length, "rows are {run, length}");
  const std::size_t width = (length + kLanes - 1) / kLanes * kLanes;
  const std::vector<double> all = padded(rows, runs_, length, width);
  const auto row = [&](std::size_t i) { return all.data() + std::min(i, runs_ - 1) * width; };
  for (std::size_t i = 0; i < runs_; ++i) {
    for (std::size_t j = i; j < runs_; j += 4) {
      const auto found =
          products_with_four(row(i), {row(j), row(j + 1), row(j + 2), row(j + 3)}, width);
      for (std::size_t o = 0; o < std::min<std::size_t>(4, runs_ - j); ++o) {
        products_[i * runs_ + j + o] += found[o];
        if (j + o > i) products_[(j + o) * runs_ + i] += found[o];
      }
    }
  }
}

void RunProducts::add(const RunProducts& other) {
  expect(runs_ == other.runs_, "products are of the same runs");
  for (std::size_t k = 0; k < products_.size(); ++k) products_[k] += other.products_[k];
}

double RunProducts::squares_with_others(std::size_t i) const {
  double sum = 0.0;
  for (std::size_t j = 0; j < runs_; ++j) {
    if (j != i) sum += (*this)(i, j) * (*this)(i, j);
  }
  return sum;
}

double RunProducts::cycles() const {
  std::vector<double> others = products_;
  for (std::size_t i = 0; i < runs_; ++i) others[i * runs_ + i] = 0.0;
  RunProducts squared(runs_);
  squared.add(others, runs_);
  double sum = 0.0;
  for (std::size_t k = 0; k < others.size(); ++k) sum += others[k] * squared.products_[k];
  return sum;
}

MeanSquaredProduct mean_squared_product(const RunProducts& products) {
  const std::size_t runs = products.runs();
  expect(runs >= 3, "a jackknife needs three runs");
  const auto n = static_cast<double>(runs);
  std::vector<double> by_run(runs);
  double sum = 0.0;
  for (std::size_t i = 0; i < runs; ++i) sum += by_run[i] = products.squares_with_others(i);
  MeanSquaredProduct found{.mean = sum / (n * (n - 1.0)), .deviation = 0.0, .without = by_run};
  double squares = 0.0;
  for (double& without : found.without) {
    without = (sum - 2.0 * without) / ((n - 1.0) * (n - 2.0));
    squares += (without - found.mean) * (without - found.mean);
  }
  found.deviation = std::sqrt(squares * (n - 1.0) / n);
  return found;
}

Traces traces_of(const RunProducts& products, double terms, double largest, double share) {
  const auto n = static_cast<double>(products.runs());
  const MeanSquaredProduct mean = mean_squared_product(products);
  Traces traces{.first = terms};
  // Errors were divided by the root mean square of the sample itself: two factors correct that.
  const double second = (n + 2.0) / n * (mean.mean + mean.deviation) / (share * share);
  traces.second = std::clamp(second, terms, std::max(terms, largest));
  const double third = (n + 2.0) * (n + 4.0) / (n * n) * products.cycles() /
                       (n * (n - 1.0) * (n - 2.0)) / (share * share * share);
  const double least = traces.second * traces.second / terms;
  const double most = std::max(least, traces.second * std::sqrt(traces.second));
  traces.third = std::clamp(third, least, most);
  const double relative = mean.deviation / mean.mean;
  traces.freedom = std::max(kFewestDegrees, 2.0 / (relative * relative));
  return traces;
}

Traces traces_of_constant_errors(double terms, double largest) {
  const double second = std::max(terms, largest);
  return {.first = terms, .second = second, .third = second * second / terms};
}

SquaresLaw::SquaresLaw(const Traces& traces, double runs) : freedom_(traces.freedom) {
  const double t1 = traces.first, t2 = traces.second, t3 = traces.third;
  shape_ = runs * t2 * t2 * t2 / (2.0 * t3 * t3);
  scale_ = 2.0 * t3 / (runs * t2 * t1);
  shift_ = 1.0 - shape_ * scale_;
}

double SquaresLaw::score(double ratio) const {
  const double x = (ratio - shift_) / scale_;
  if (!(x > 0.0)) return -kFarthestScore;
  if (!std::isfinite(x)) return kFarthestScore;
  return score_of_tails(boost::math::gamma_p(shape_, x), boost::math::gamma_q(shape_, x));
}

double SquaresLaw::quantile(double score) const {
  const double tail = normal_cdf(-std::min(std::abs(score), kFarthestScore));
  const double x =
      score < 0.0 ? boost::math::gamma_p_inv(shape_, tail) : boost::math::gamma_q_inv(shape_, tail);
  return shift_ + scale_ * x;
}

double SquaresLaw::p_value(double ratio) const { return t_p_value(score(ratio), freedom_); }

Interval SquaresLaw::interval(double ratio, double level) const {
  const double score = t_score(level, freedom_);
  const double low = quantile(-score);
  return {ratio / quantile(score),
          low > 0.0 ? ratio / low : std::numeric_limits<double>::infinity()};
}

}  // namespace montecarta::analysis
