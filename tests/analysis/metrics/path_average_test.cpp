// SPDX-License-Identifier: BSD-3-Clause
// Why the mean over paths of the recursion along each of them is called a reference and no bound:
// one number x with the prior N(0, 1), observed as z = x^3 + v.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr double kSeenSigma = 0.1;  // of v
constexpr double kPriorStep = 0.002, kPriorEnd = 6.0;
constexpr double kSeenStep = 0.02;  // a fifth of sigma

double normal_density(double x, double sigma) {
  return std::exp(-0.5 * x * x / (sigma * sigma)) / (sigma * std::sqrt(2.0 * M_PI));
}

/// Sum of value(x) times the prior's probability.
template <class Value>
double over_prior(const Value& value) {
  double sum = 0.0;
  for (double x = -kPriorEnd; x <= kPriorEnd; x += kPriorStep)
    sum += value(x) * normal_density(x, 1.0) * kPriorStep;
  return sum;
}

/// Information of z about x where x is known.
double information_of_cube(double x) { return 9.0 * std::pow(x, 4) / (kSeenSigma * kSeenSigma); }

/// Mean square error of the conditional mean, of which no estimator is better.
double least_error() {
  double of_means = 0.0;  // E[x^2] is 1
  for (double z = -150.0; z <= 150.0; z += kSeenStep) {
    // Where x^3 is within six sigma of z.
    const double low = std::cbrt(z - 6.0 * kSeenSigma), high = std::cbrt(z + 6.0 * kSeenSigma);
    const double step = (high - low) / 400.0;
    double density = 0.0, first = 0.0;
    for (double x = low; x <= high; x += step) {
      const double p = normal_density(x, 1.0) * normal_density(z - x * x * x, kSeenSigma) * step;
      density += p;
      first += x * p;
    }
    if (density > 0.0) of_means += first * first / density * kSeenStep;
  }
  return 1.0 - of_means;
}

TEST(MeanOverPathsOfTheRecursion, IsNoBound) {
  const double reference =
      over_prior([](double x) { return 1.0 / (1.0 + information_of_cube(x)); });
  const double achieved = least_error();
  EXPECT_NEAR(reference, 0.160, 0.001);
  EXPECT_NEAR(achieved, 0.040, 0.002);
  EXPECT_GT(reference, 3.5 * achieved);
  // Information averaged first, the bound of Van Trees, is one, and a loose one.
  EXPECT_LT(1.0 / (1.0 + over_prior(information_of_cube)), achieved);
}

}  // namespace
}  // namespace montecarta::analysis
