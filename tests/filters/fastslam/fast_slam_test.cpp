// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_filters.hpp"
#include "tests/filters/reference/fast_slam1.hpp"
#include "tests/filters/reference/fast_slam2.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace montecarta {
namespace {

struct Variant {
  std::string filter;
  std::string weights = "closed";
  Association association = Association::known;
  std::size_t particles = 13;  // not a multiple of the lanes

  friend std::ostream& operator<<(std::ostream& out, const Variant& v) {
    return out << v.filter << '_' << v.weights
               << (v.association == Association::known ? "_known" : "_nearest") << '_'
               << v.particles;
  }
};

FilterSetup setup_of(const Variant& v, const SmallWorldSettings& world) {
  return {.belief = world.noise,
          .association = {.kind = v.association},
          .options = FilterOptions({{"particles", std::to_string(v.particles)},
                                    {"resampling", "systematic"},
                                    {"resample_below", "0.5"},
                                    {"weights", v.weights}}),
          .landmarks = world.landmarks};
}

template <class Real>
std::unique_ptr<SlamFilter> make(const Variant& v, const SmallWorldSettings& world) {
  const FilterSetup setup = setup_of(v, world);
  return v.filter == "fastslam1" ? make_fastslam1<Real>(setup) : make_fastslam2<Real>(setup);
}

std::unique_ptr<SlamFilter> make_reference(const Variant& v, const SmallWorldSettings& world) {
  const reference::FastSlamSettings settings{.particles = v.particles,
                                             .belief = world.noise,
                                             .association = {.kind = v.association},
                                             .landmarks = world.landmarks};
  if (v.filter == "fastslam1") return std::make_unique<reference::FastSlam1>(settings);
  const auto weight = v.weights == "ratio"   ? reference::Weight::ratio
                      : v.weights == "batch" ? reference::Weight::batch
                                             : reference::Weight::closed;
  return std::make_unique<reference::FastSlam2>(settings, weight);
}

void expect_near(const PoseMoments& a, const PoseMoments& b, double tolerance) {
  EXPECT_LT(boxminus(a.mean, b.mean).norm(), tolerance);
  EXPECT_LT((a.covariance - b.covariance).norm(), tolerance);
}

class FastSlams : public testing::TestWithParam<Variant> {};

TEST_P(FastSlams, LanesEqualOneParticleAtATime) {
  const SmallWorldSettings settings;
  const SmallWorld world = small_world(settings);
  const auto lanes = make<Lanes>(GetParam(), settings);
  const auto single = make<double>(GetParam(), settings);
  std::vector<PoseEstimate> estimates;
  std::vector<ScanReport> reports;
  drive_through(*lanes, world, Pose(), [&](std::size_t) {
    estimates.push_back(lanes->estimate());
    reports.push_back(lanes->report());
  });
  drive_through(*single, world, Pose(), [&](std::size_t scan) {
    expect_near(single->estimate().spread, estimates[scan].spread, 1e-9);
    EXPECT_NEAR(single->report().ess, reports[scan].ess, 1e-6);
    EXPECT_NEAR(single->report().log_likelihood, reports[scan].log_likelihood, 1e-6);
    EXPECT_NEAR(single->report().nis, reports[scan].nis, 1e-6 * (1 + reports[scan].nis));
    EXPECT_EQ(single->report().resampled, reports[scan].resampled);
  });
}

TEST_P(FastSlams, EqualsTheEigenReference) {
  const SmallWorldSettings settings;
  const SmallWorld world = small_world(settings);
  const auto lanes = make<Lanes>(GetParam(), settings);
  const auto plain = make_reference(GetParam(), settings);
  std::vector<PoseEstimate> estimates;
  std::vector<ScanReport> reports;
  drive_through(*lanes, world, Pose(), [&](std::size_t) {
    estimates.push_back(lanes->estimate());
    reports.push_back(lanes->report());
  });
  drive_through(*plain, world, Pose(), [&](std::size_t scan) {
    expect_near(plain->estimate().spread, estimates[scan].spread, 1e-8);
    ASSERT_EQ(plain->estimate().mixture.has_value(), estimates[scan].mixture.has_value());
    if (estimates[scan].mixture)
      expect_near(*plain->estimate().mixture, *estimates[scan].mixture, 1e-8);
    EXPECT_NEAR(plain->report().ess, reports[scan].ess, 1e-5);
    EXPECT_NEAR(plain->report().log_likelihood, reports[scan].log_likelihood, 1e-5);
    EXPECT_EQ(plain->report().resampled, reports[scan].resampled);
  });
}

TEST_P(FastSlams, EstimatesBetweenScansAsTheReferenceDoes) {
  const SmallWorldSettings settings{.scans = 12};
  const SmallWorld world = small_world(settings);
  const auto lanes = make<Lanes>(GetParam(), settings);
  const auto plain = make_reference(GetParam(), settings);
  lanes->start(Pose()), plain->start(Pose());
  for (std::uint32_t step = 0, scan = 0; step < world.itinerary.steps(); ++step) {
    const StepContext context(world.seed, 0, step, Parallel::serial());
    for (SlamFilter* filter : {lanes.get(), plain.get()}) {
      filter->predict(context, world.drive.controls[step], world.itinerary.duration(step));
    }
    expect_near(plain->estimate().spread, lanes->estimate().spread, 1e-9);
    if (lanes->estimate().mixture)
      expect_near(*plain->estimate().mixture, *lanes->estimate().mixture, 1e-9);
    if (world.itinerary.scan_step[scan] != step) continue;
    for (SlamFilter* filter : {lanes.get(), plain.get()})
      filter->update(context, world.drive.scan(scan));
    ++scan;
  }
}

TEST_P(FastSlams, FollowsTheTruth) {
  const SmallWorldSettings settings;
  const SmallWorld world = small_world(settings);
  const auto filter = make<Lanes>(GetParam(), settings);
  drive_through(*filter, world, Pose(), [&](std::size_t scan) {
    const Pose& truth = world.drive.truth[world.itinerary.scan_step[scan]];
    EXPECT_LT(boxminus(filter->estimate().spread.mean, truth).norm(), 2.0) << "scan " << scan;
  });
}

TEST_P(FastSlams, ForgetsTheRunBefore) {
  const SmallWorldSettings settings;
  const SmallWorld world = small_world(settings);
  const auto filter = make<Lanes>(GetParam(), settings);
  std::vector<double> first;
  drive_through(*filter, world, Pose(),
                [&](std::size_t) { first.push_back(filter->estimate().spread.mean.x); });
  drive_through(*filter, world, Pose(), [&](std::size_t scan) {
    EXPECT_EQ(filter->estimate().spread.mean.x, first[scan]);
  });
}

INSTANTIATE_TEST_SUITE_P(All, FastSlams,
                         testing::Values(Variant{"fastslam1"}, Variant{"fastslam2"},
                                         Variant{"fastslam2", "ratio"},
                                         Variant{"fastslam2", "batch"},
                                         Variant{"fastslam1", "closed", Association::nearest},
                                         Variant{"fastslam2", "closed", Association::nearest},
                                         Variant{"fastslam2", "batch", Association::nearest, 40},
                                         Variant{"fastslam2", "ratio", Association::nearest, 8},
                                         Variant{"fastslam2", "closed", Association::known, 1},
                                         Variant{"fastslam1", "closed", Association::known, 9}),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace montecarta
