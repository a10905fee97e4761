// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/anchored.hpp"

#include "filters/fastslam/de_srcd.hpp"
#include "filters/fastslam/srcd.hpp"
#include "filters/fastslam/ufastslam.hpp"
#include "tests/filters/fastslam/filter_comparison.hpp"
#include "tests/filters/reference/anchored_fast_slam.hpp"
#include "tests/filters/reference/de_srcd_fast_slam.hpp"
#include "tests/filters/reference/fast_slam1.hpp"
#include "tests/filters/reference/ufast_slam.hpp"

namespace montecarta {
namespace {

Variant anchored(const char* filter, const char* weights = "closed",
                 Association association = Association::known, std::size_t particles = 13) {
  return {filter, weights, association, particles, {{"landmarks", "anchored"}}};
}
Variant evolved(const char* mode, std::size_t particles,
                Association association = Association::known) {
  return {"de_srcd", "closed", association, particles, {{"landmarks", "anchored"}, {"mode", mode}}};
}

std::unique_ptr<SlamFilter> make_single(const Variant& v, const SmallWorldSettings& world) {
  const FilterSetup setup = setup_of(v, world);
  if (v.filter == "fastslam1") return make_fastslam1_anchored<double>(setup);
  if (v.filter == "de_srcd") return make_de_srcd_anchored<double>(setup);
  if (v.filter == "fastslam2" || v.filter == "srcd_aided")
    return make_anchored<double>(setup, Linearised());
  return make_anchored<double>(
      setup, v.filter == "ufastslam" ? unscented_points(setup) : srcd_points(setup));
}

std::unique_ptr<SlamFilter> make_reference(const Variant& v, const SmallWorldSettings& world) {
  using namespace reference;
  const reference::FastSlamSettings settings = reference_settings(v, world);
  const Weight weight = reference_weight(v);
  const SrcdParts poses_alone{.map = false};
  if (v.filter == "fastslam1") return std::make_unique<AnchoredMaps<FastSlam1>>(settings);
  if (v.filter == "ufastslam")
    return std::make_unique<AnchoredMaps<UFastSlam>>(settings, weight, Unscented{}, true);
  if (v.filter == "srcd" || v.filter == "srcd_pf")
    return std::make_unique<AnchoredMaps<SrcdFastSlam>>(settings, weight, poses_alone);
  if (v.filter == "de_srcd") {
    const auto mode = static_cast<DeMode>(evolved_settings(setup_of(v, world).options).mode);
    return std::make_unique<AnchoredMaps<DeSrcdFastSlam>>(settings, poses_alone,
                                                          DeSettings{.mode = mode});
  }
  return std::make_unique<AnchoredMaps<FastSlam2>>(settings, weight);
}

class AnchoredSigmaFilters : public testing::TestWithParam<Variant> {};
class AnchoredFilters : public testing::TestWithParam<Variant> {};

void expect_lanes_equal_one_at_a_time(const Variant& v) {
  const SmallWorldSettings settings = rough_small_world();
  const auto lanes = make_production(v, settings);
  const auto single = make_single(v, settings);
  expect_same_run(*lanes, *single, small_world(settings), 1e-9);
}

void expect_not_the_filter_with_gaussians_in_the_map(const Variant& v) {
  const SmallWorldSettings settings = rough_small_world();
  Variant in_map = v;
  in_map.options.erase("landmarks");
  const auto one = make_production(v, settings), other = make_production(in_map, settings);
  drive_through(*one, small_world(settings), Pose(), [](std::size_t) {});
  drive_through(*other, small_world(settings), Pose(), [](std::size_t) {});
  const double apart = boxminus(one->estimate().spread.mean, other->estimate().spread.mean).norm();
  EXPECT_GT(apart, 1e-6);
  EXPECT_LT(apart, 5.0);
}

TEST_P(AnchoredFilters, LanesEqualOneParticleAtATime) {
  expect_lanes_equal_one_at_a_time(GetParam());
}
TEST_P(AnchoredSigmaFilters, LanesEqualOneParticleAtATime) {
  expect_lanes_equal_one_at_a_time(GetParam());
}
TEST_P(AnchoredFilters, AreNotTheFilterWithGaussiansInTheMap) {
  expect_not_the_filter_with_gaussians_in_the_map(GetParam());
}
TEST_P(AnchoredSigmaFilters, AreNotTheFilterWithGaussiansInTheMap) {
  expect_not_the_filter_with_gaussians_in_the_map(GetParam());
}

TEST_P(AnchoredFilters, EqualsTheEigenReference) {
  const SmallWorldSettings settings = rough_small_world();
  const auto plain = make_reference(GetParam(), settings);
  const auto lanes = make_production(GetParam(), settings);
  expect_same_run(*lanes, *plain, small_world(settings), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(
    All, AnchoredFilters,
    testing::Values(anchored("fastslam1"), anchored("fastslam2"), anchored("fastslam2", "ratio"),
                    anchored("fastslam2", "batch"),
                    anchored("fastslam1", "closed", Association::nearest),
                    anchored("fastslam2", "closed", Association::nearest, 9), anchored("ufastslam"),
                    anchored("srcd"), anchored("srcd", "ratio", Association::nearest),
                    anchored("srcd_aided"), anchored("srcd_aided", "ratio", Association::nearest),
                    anchored("srcd_pf", "ratio"),
                    anchored("srcd_pf", "closed", Association::nearest, 9), evolved("honest", 10),
                    evolved("as_printed", 11), evolved("prior", 3), evolved("shared", 9),
                    evolved("honest", 5, Association::nearest)),
    testing::PrintToStringParamName());
INSTANTIATE_TEST_SUITE_P(All, AnchoredSigmaFilters,
                         testing::Values(anchored("ufastslam", "ratio"),
                                         anchored("ufastslam", "closed", Association::nearest)),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace montecarta
