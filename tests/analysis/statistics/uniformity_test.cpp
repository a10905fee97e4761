// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/uniformity.hpp"

#include "engine/random/stream.hpp"

#include <boost/math/distributions/normal.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

/// PIT values of a filter whose errors are `inflation` times what it says, and `bias` deviations
/// aside.
std::vector<double> pits(std::size_t n, double inflation, double bias, std::uint64_t study) {
  RngStream draw({.seed = 77, .run = study});
  const boost::math::normal standard;
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    values.push_back(cdf(standard, bias + inflation * draw.normal()));
  }
  return values;
}

double alarms(std::size_t n, double inflation, double bias, Calibration verdict) {
  constexpr std::uint64_t kStudies = 2000;
  const CountBand band = band_for(n, 0.95);
  double found = 0.0;
  for (std::uint64_t study = 0; study < kStudies; ++study) {
    const auto values = pits(n, inflation, bias, study);
    if (judge_uniformity(values, band).verdict == verdict) found += 1.0 / kStudies;
  }
  return found;
}

// The band's own probability is exact, so that the rate of false alarms is known: 1 - joint, a
// little below 5 % since counts are whole. 2000 studies, 4 standard errors.
TEST(Uniformity, RaisesFalseAlarmsAtTheStatedLevel) {
  for (const std::size_t n : {60u, 200u}) {
    const double rate = 1.0 - band_for(n, 0.95).joint;
    EXPECT_LE(rate, 0.05);
    EXPECT_GT(rate, 0.025);
    EXPECT_NEAR(1.0 - alarms(n, 1.0, 0.0, Calibration::calibrated), rate,
                4.0 * std::sqrt(rate * (1.0 - rate) / 2000.0));
  }
}

TEST(Uniformity, NamesWhatIsWrong) {
  EXPECT_GT(alarms(200, 1.6, 0.0, Calibration::too_narrow), 0.95);
  EXPECT_GT(alarms(200, 0.6, 0.0, Calibration::too_wide), 0.95);
  EXPECT_GT(alarms(200, 1.0, 0.6, Calibration::shifted), 0.95);
}

// Two bins are one binomial: the band's probability by hand.
TEST(Uniformity, KnowsTheProbabilityOfItsBand) {
  const CountBand band = joint_band(4, 2, 0.5);
  EXPECT_EQ(band.lower, 1u);
  EXPECT_EQ(band.upper, 3u);
  EXPECT_NEAR(band.joint, 14.0 / 16.0, 1e-12);
}

TEST(Uniformity, SaysNothingOfAFew) {
  EXPECT_EQ(judge_uniformity(pits(kLeastValues - 1, 9.0, 0.0, 0), {}).verdict,
            Calibration::untested);
  EXPECT_EQ(judge_uniformity({}, {}).verdict, Calibration::untested);
}

}  // namespace
}  // namespace montecarta::analysis
