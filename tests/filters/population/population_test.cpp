// SPDX-License-Identifier: BSD-3-Clause
#include "filters/population/population.hpp"

#include "engine/random/stream.hpp"
#include "filters/setup/filter_setup.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace montecarta::filters {
namespace {

const StepContext kContext(1, 0, 0, Parallel::serial());

TEST(CloudMoments, MoveAsEveryPoseDoesHoweverWideTheCloud) {
  for (const double width : {0.01, 1.0, kPi}) {
    RngStream draw({3, 0, 0, 0, Draw::test});
    Weights<double> weights(9);
    std::vector<BasicPose<double>> poses(9);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      poses[i] = {10 * draw.normal(), 10 * draw.normal(),
                  wrap(3.0 + width * (2 * draw.uniform() - 1))};
      weights.multiply(i, draw.normal());
    }
    weights.normalise(kContext);
    MotionIncrement motion;
    for (int k = 0; k < 5; ++k) motion.advance({3.0, 0.3}, 0.1, Belief{});
    const PoseMoments closed = CloudMoments(kContext, weights, poses).moved_by(motion);
    std::vector<PoseGaussian<double>> moved;
    for (const auto& pose : poses) moved.push_back(motion.from(pose));
    const PoseMoments mixture = mixture_of(kContext, weights, moved);
    EXPECT_LT((closed.covariance - mixture.covariance).norm(), 1e-9) << width;
    EXPECT_LT(boxminus(closed.mean, mixture.mean).norm(), 1e-9) << width;
  }
}

/// What is reported of a scan with one detection that has this innovation.
ScanReport report_of(Measurement<double> value, Symmetric2<double> S) {
  MixtureInnovations<double> innovations;
  innovations.start(kContext, 1, 1, 1.0);
  innovations.of_block(0, 1.0).add(0, {value, S}, AllLanes());
  ScanReport report;
  innovations.add_to(kContext, report);
  return report;
}

TEST(MixtureInnovations, WithoutAPositiveDefiniteCovarianceAreNumericalFaults) {
  const ScanReport good = report_of({0.2, 0.0}, {0.04, 0.0, 1.0});
  EXPECT_DOUBLE_EQ(good.nis, 1.0);
  EXPECT_EQ(good.nis_dof, 2U);
  EXPECT_EQ(good.numerical_faults, 0U);
  for (const ScanReport& bad : {report_of({0.2, 0.0}, {1.0, 2.0, 1.0}),
                                report_of({1e16, 1e15}, {0.01, 0.0, 0.01}),  // lost in rounding
                                report_of({0.2, 0.0}, {0.0, 0.0, 0.0})}) {
    EXPECT_EQ(bad.nis, 0.0);
    EXPECT_EQ(bad.nis_dof, 0U);
    EXPECT_EQ(bad.numerical_faults, 1U);
  }
}

}  // namespace
}  // namespace montecarta::filters
