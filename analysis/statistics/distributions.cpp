// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/distributions.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/policies/policy.hpp>
#include <boost/math/tools/toms748_solve.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace montecarta::analysis {
namespace {

using boost::math::cdf;
using boost::math::complement;
using boost::math::quantile;

constexpr double kLeastTail = 1e-17;  // tail of a level that rounding made 1
constexpr double kLeastTailOfSquares = 1e-300;

/// A factor overflows for values far below a large freedom, although the results are 0 and 1.
using IgnoringOverflow = boost::math::policies::policy<
    boost::math::policies::overflow_error<boost::math::policies::ignore_error>>;
using ChiSquared = boost::math::chi_squared_distribution<double, IgnoringOverflow>;

}  // namespace

double normal_cdf(double z) { return cdf(boost::math::normal(), z); }
double normal_quantile(double probability) { return quantile(boost::math::normal(), probability); }

double chi_squared_cdf(double value, double freedom) { return cdf(ChiSquared(freedom), value); }
double chi_squared_tail(double value, double freedom) {
  return cdf(complement(ChiSquared(freedom), value));
}
double chi_squared_quantile(double probability, double freedom) {
  return quantile(ChiSquared(freedom), probability);
}
double chi_squared_beyond(double tail, double freedom) {
  return quantile(complement(ChiSquared(freedom), tail));
}

double chi_squared_before_gate(double value, double freedom, double most) {
  const double beyond = chi_squared_tail(most, freedom);
  const double inside = std::min(value, most * (1.0 - kRoundingOfGate));
  const double tail = (chi_squared_tail(inside, freedom) - beyond) / (1.0 - beyond);
  if (!(tail > kLeastTailOfSquares)) return value;  // no gate so far out leaves anything out
  return chi_squared_beyond(tail, freedom);
}

double chi_squared_scale_up_to(double most, double freedom, double mean) {
  // The likelihood is largest where the expectation of a value is `mean`.
  const auto beyond_mean = [&](double log_scale) {
    const double scale = std::exp(log_scale), limit = most / scale;
    return freedom * scale * chi_squared_cdf(limit, freedom + 2.0) /
               chi_squared_cdf(limit, freedom) -
           mean;
  };
  const double least = std::log(mean / freedom), largest = std::log(1000.0 * most);
  if (!(beyond_mean(least) < 0.0)) return mean / freedom;
  if (!(beyond_mean(largest) > 0.0)) return 1000.0 * most;
  std::uintmax_t steps = 100;
  const auto [below, above] = boost::math::tools::toms748_solve(
      beyond_mean, least, largest, boost::math::tools::eps_tolerance<double>(30), steps);
  return std::exp(0.5 * (below + above));
}

double t_cdf(double t, double freedom) { return cdf(boost::math::students_t(freedom), t); }

double t_p_value(double t, double freedom) {
  const double distance = std::abs(t);
  if (!std::isfinite(distance)) return std::isnan(distance) ? distance : 0.0;
  return 2.0 * (std::isfinite(freedom) ? t_cdf(-distance, freedom) : normal_cdf(-distance));
}

double t_score(double level, double freedom) {
  const double tail = std::max(0.5 * (1.0 - level), kLeastTail);
  return std::isfinite(freedom) ? quantile(complement(boost::math::students_t(freedom), tail))
                                : -normal_quantile(tail);
}

}  // namespace montecarta::analysis
