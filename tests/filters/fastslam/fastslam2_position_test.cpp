// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fastslam2_position.hpp"

#include "filters/joint/joint_filters.hpp"
#include "tests/filters/default_options.hpp"
#include "tests/filters/two_scans.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

SmallWorldSettings positions_of_two_scans() {
  SmallWorldSettings settings = settings_of_two_scans();
  settings.noise.sensor = {PositionSensor(), {}};
  settings.noise.sigma_left = 0.2;
  return settings;
}

FilterSetup setup_of(const FilterKind& kind, const std::string& weights = {}) {
  std::map<std::string, std::string, std::less<>> special;
  if (kind.has_particles) special = {{"particles", "30"}, {"weights", weights}};
  return {.belief = positions_of_two_scans().noise,
          .association = {},
          .options = default_options(kind, special),
          .landmarks = 40};
}

/// As FastSlam2.SeeingAgainFromAKnownPoseIsTheKalmanFiltersUpdate.
TEST(FastSlam2Position, SeeingAgainFromAKnownPoseIsTheKalmanFiltersUpdate) {
  const SmallWorld world = drive_of_two_scans(positions_of_two_scans());
  const auto kalman = make_ekf_slam(setup_of(ekf_slam_kind()));
  const PoseMoments expected = after_two_scans(*kalman, world).spread;
  EXPECT_GE(kalman->report().nis_dof, 4U);
  const auto filter = make_fastslam2_position<Lanes>(setup_of(fastslam2_kind(), "closed"));
  const PoseMoments mixture = *after_two_scans(*filter, world).mixture;
  EXPECT_LT(boxminus(mixture.mean, expected.mean).norm(), 1e-12);
  EXPECT_LT((mixture.covariance - expected.covariance).norm(), 1e-13);
  EXPECT_NEAR(filter->report().log_likelihood, kalman->report().log_likelihood, 1e-9);
  EXPECT_NEAR(filter->report().nis, kalman->report().nis, 1e-9);
}

/// Where the heading is all but known the model is linear: the batch is the sequence.
TEST(FastSlam2Position, WeighsByTheBatchAsByTheSequenceWhereTheModelIsLinear) {
  const SmallWorld world = drive_of_two_scans(positions_of_two_scans());
  const auto log_likelihood = [&](const std::string& weights) {
    FilterSetup setup = setup_of(fastslam2_kind(), weights);
    setup.belief.control.sigma[1] = 1e-7;
    const auto filter = make_fastslam2_position<Lanes>(setup);
    after_two_scans(*filter, world);
    return filter->report().log_likelihood;
  };
  EXPECT_NEAR(log_likelihood("batch"), log_likelihood("closed"), 1e-3);
}

TEST(FastSlam2Position, LanesAreParticlesOneByOne) {
  SmallWorldSettings settings = positions_of_two_scans();
  settings.scans = 20;
  const SmallWorld world = small_world(settings);
  for (const char* weights : {"closed", "ratio", "batch"}) {
    const FilterSetup setup = setup_of(fastslam2_kind(), weights);
    const auto lanes = make_fastslam2_position<Lanes>(setup);
    const auto scalar = make_fastslam2_position<double>(setup);
    std::vector<PoseMoments> expected;
    drive_through(*scalar, world, {},
                  [&](std::size_t) { expected.push_back(scalar->estimate().spread); });
    drive_through(*lanes, world, {}, [&](std::size_t scan) {
      EXPECT_LT(boxminus(lanes->estimate().spread.mean, expected[scan].mean).norm(), 1e-6)
          << weights << ", scan " << scan;
    });
  }
}

}  // namespace
}  // namespace montecarta::filters
