// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_filters.hpp"
#include "tests/filters/fastslam/filter_comparison.hpp"

namespace montecarta::filters {
namespace {

std::unique_ptr<SlamFilter> make_single(const Variant& v, const SmallWorldSettings& world) {
  const FilterSetup setup = setup_of(v, world);
  return v.filter == "fastslam1" ? make_fastslam1<double>(setup) : make_fastslam2<double>(setup);
}
std::unique_ptr<SlamFilter> make_reference(const Variant& v, const SmallWorldSettings& world) {
  const reference::FastSlamSettings settings = reference_settings(v, world);
  if (v.filter == "fastslam1") return reference::make_fast_slam1(settings);
  return reference::make_fast_slam2(settings, reference_weight(v));
}

class FastSlams : public testing::TestWithParam<Variant> {};

TEST_P(FastSlams, LanesEqualOneParticleAtATime) {
  const SmallWorldSettings settings;
  const auto lanes = make_production(GetParam(), settings);
  const auto single = make_single(GetParam(), settings);
  expect_same_run(*lanes, *single, small_world(settings), 1e-10);
}

TEST_P(FastSlams, EqualsTheEigenReference) {
  const SmallWorldSettings settings;
  const auto lanes = make_production(GetParam(), settings);
  const auto plain = make_reference(GetParam(), settings);
  expect_same_run(*lanes, *plain, small_world(settings), 1e-8);
}

TEST_P(FastSlams, EstimatesBetweenScansAsTheReferenceDoes) {
  const SmallWorldSettings settings{.scans = 12};
  const auto lanes = make_production(GetParam(), settings);
  const auto plain = make_reference(GetParam(), settings);
  expect_same_steps(*lanes, *plain, small_world(settings), 1e-9);
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
}  // namespace montecarta::filters
