// SPDX-License-Identifier: BSD-3-Clause
// A landmark seen again and again from one exactly known pose.
#include "filters/models/eigen_jacobians.hpp"
#include "filters/moments/sigma_points.hpp"
#include "tests/filters/moments/random_gaussians.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace montecarta::filters {
namespace {

constexpr int kRuns = 2000;
const Eigen::Vector2d kTruth(25.0, 0.0);

/// Averages over the runs after a number of observations.
struct Averages {
  double nees = 0.0;
  double short_by = 0.0;  ///< how much nearer than the truth the landmark is believed [m]
};

template <class Transform>
std::map<int, Averages> watch(const Transform& transform, const Belief& belief) {
  const SensorNoise noise = SensorNoise::of(belief);
  std::map<int, Averages> after;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    RngStream draw({.seed = 2313, .run = run, .purpose = Draw::test});
    LandmarkGaussian<double> landmark;
    Evidence<double> evidence;
    for (int n = 1; n <= 64; ++n) {
      const Measurement<double> seen{kTruth.x() + belief.sigma_range * draw.normal(),
                                     belief.sigma_bearing * draw.normal()};
      if (n == 1) {
        landmark = transform.initialise(Pose(), seen, noise);
      } else {
        transform.update(landmark, Pose(), seen, noise, AllLanes(), evidence);
      }
      const Eigen::Vector2d e = kTruth - to_vector(landmark.mean);
      after[n].nees += e.dot(symmetric(landmark.covariance).llt().solve(e)) / kRuns;
      after[n].short_by += e.x() / kRuns;
    }
  }
  return after;
}

Belief sensor(double sigma_range, double sigma_bearing_deg) {
  Belief belief;
  belief.sigma_range = sigma_range, belief.sigma_bearing = sigma_bearing_deg * kPi / 180.0;
  return belief;
}

SigmaPoints points(const SigmaRule& rule, const Belief& belief) {
  return SigmaPoints({rule, rule, rule}, belief, MapUncertainty::on);
}
SigmaPoints unscented(const Belief& belief) { return points(unscented_rule(2, 0.9, 2, 0), belief); }
SigmaPoints central(const Belief& belief) {
  return points(central_difference_rule(std::sqrt(3.0)), belief);
}

TEST(LandmarkAlone, IsConsistentWhereNoiseIsSmall) {
  const Belief fine = sensor(0.01, 0.1);
  for (const auto& after :
       {watch(Linearised(), fine), watch(unscented(fine), fine), watch(central(fine), fine)}) {
    for (const int n : {1, 2, 4, 8, 16, 32, 64}) {
      EXPECT_NEAR(after.at(n).nees, 2.0, 5.0 * 2.0 / std::sqrt(kRuns)) << n << " observations";
      EXPECT_NEAR(after.at(n).short_by, 0.0, 1e-3) << n << " observations";
    }
  }
}

TEST(LandmarkAlone, SigmaPointsStayConsistentInTheNoiseOfTheFirstPaperButStandTooNear) {
  const Belief rough = sensor(1.2, 12.0);
  const std::map<int, double> too_near{{1, 1.08}, {2, 0.54}, {4, 0.30}, {8, 0.15}};
  for (const auto& after : {watch(unscented(rough), rough), watch(central(rough), rough)}) {
    for (const auto& [n, average] : after) {
      EXPECT_GT(average.nees, 1.75) << n << " observations";
      EXPECT_LT(average.nees, 2.6) << n << " observations";
    }
    for (const auto& [n, metres] : too_near) {
      EXPECT_NEAR(after.at(n).short_by, metres, 0.1) << n << " observations";
    }
  }
}

TEST(LandmarkAlone, TheLinearisedOneIsOverconfidentInThatNoise) {
  const Belief rough = sensor(1.2, 12.0);
  const auto after = watch(Linearised(), rough);
  for (const int n : {2, 4, 8, 16}) {
    EXPECT_GT(after.at(n).nees, 2.7) << n << " observations";
    EXPECT_LT(after.at(n).nees, 3.4) << n << " observations";
    EXPECT_LT(std::abs(after.at(n).short_by), 0.2) << n << " observations";
  }
}

}  // namespace
}  // namespace montecarta::filters
