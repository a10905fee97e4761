// SPDX-License-Identifier: BSD-3-Clause
// The plain FastSLAM filters in a world of rough noise; EveryFilter and FastSlams have the rest.
#include "tests/filters/fastslam/filter_comparison.hpp"

#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

/// So much noise on the motion that the controls alone soon lead astray.
Belief rough() {
  Belief belief;
  belief.control.sigma[0] = 1.0;
  belief.control.sigma[1] = 0.25;
  return belief;
}

/// Root of the mean squared position error over the scans [m].
double position_error(SlamFilter& filter, const SmallWorld& world) {
  double squares = 0.0;
  drive_through(filter, world, {}, [&](std::size_t s) {
    const Pose& truth = world.drive.truth[world.itinerary.scan_step[s]];
    squares += boxminus(truth, filter.estimate().spread.mean).head<2>().squaredNorm();
  });
  return std::sqrt(squares / static_cast<double>(world.itinerary.scans()));
}

class PlainFastSlam : public ::testing::TestWithParam<Association> {};

TEST_P(PlainFastSlam, EveryFormBeatsDeadReckoning) {
  const SmallWorldSettings settings{.seed = 42, .scans = 150, .noise = rough()};
  const SmallWorld world = small_world(settings);
  const auto controls = kind_of({"dead_reckoning"}).make(setup_of({"dead_reckoning"}, settings));
  const double alone = position_error(*controls, world);
  for (const Variant& variant : {Variant{"fastslam1"}, Variant{"fastslam2", "closed"},
                                 Variant{"fastslam2", "ratio"}, Variant{"fastslam2", "batch"}}) {
    Variant form = variant;
    form.association = GetParam();
    form.particles = 30;
    EXPECT_LT(position_error(*make_plain(form, settings), world), 0.5 * alone) << form;
  }
}

INSTANTIATE_TEST_SUITE_P(KnownAndNearest, PlainFastSlam,
                         ::testing::Values(Association::known, Association::nearest));

TEST(FastSlam2, AScanOfNothingLeavesTheParticlesUndrawnAndTheirCovarianceInTheEstimate) {
  for (const std::string prefix : {"", "plain_"}) {
    const Variant variant{.filter = "fastslam2", .particles = 30};
    const auto filter = kind_of({prefix + variant.filter}).make(setup_of(variant, {}));
    const StepContext context(1, 0, 0, Parallel::serial());
    filter->start({});
    filter->predict(context, {3.0, 0.1}, 0.025);
    const PoseEstimate before = filter->estimate();
    filter->update(context, {});
    EXPECT_GT(before.mixture->covariance.diagonal().minCoeff(), 0.0) << prefix;
    EXPECT_EQ(filter->estimate().mixture->covariance, before.mixture->covariance) << prefix;
    EXPECT_EQ(filter->estimate().spread.covariance, before.mixture->covariance) << prefix;
    EXPECT_NEAR(filter->report().ess, 30.0, 1e-9) << prefix;
  }
}

}  // namespace
}  // namespace montecarta::filters
