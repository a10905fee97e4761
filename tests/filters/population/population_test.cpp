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

}  // namespace
}  // namespace montecarta::filters
