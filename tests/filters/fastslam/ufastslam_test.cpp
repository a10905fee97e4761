// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_filters.hpp"
#include "tests/filters/fastslam/filter_comparison.hpp"

namespace montecarta::filters {
namespace {

std::unique_ptr<SlamFilter> make_single(const Variant& v, const SmallWorldSettings& world) {
  return make_ufastslam<double>(setup_of(v, world));
}
std::unique_ptr<SlamFilter> make_reference(const Variant& v, const SmallWorldSettings& world) {
  const FilterOptions options = setup_of(v, world).options;
  const reference::Unscented unscented{options.number("alpha"), options.number("beta"),
                                       options.number("kappa")};
  return reference::make_ufast_slam(reference_settings(v, world), reference_weight(v), unscented,
                                    options.choice("map_uncertainty") == "on");
}

class UFastSlams : public testing::TestWithParam<Variant> {};

TEST_P(UFastSlams, LanesEqualOneParticleAtATime) {
  const SmallWorldSettings settings;
  const auto lanes = make_production(GetParam(), settings);
  const auto single = make_single(GetParam(), settings);
  expect_same_run(*lanes, *single, small_world(settings), 1e-10);
}

TEST_P(UFastSlams, EqualsTheEigenReference) {
  const SmallWorldSettings settings;
  const auto lanes = make_production(GetParam(), settings);
  const auto plain = make_reference(GetParam(), settings);
  expect_same_run(*lanes, *plain, small_world(settings), 1e-8);
}

TEST_P(UFastSlams, EstimatesBetweenScansAsTheReferenceDoes) {
  const SmallWorldSettings settings{.scans = 12};
  const auto lanes = make_production(GetParam(), settings);
  const auto plain = make_reference(GetParam(), settings);
  expect_same_steps(*lanes, *plain, small_world(settings), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(
    All, UFastSlams,
    testing::Values(
        Variant{"ufastslam"}, Variant{"ufastslam", "ratio"},
        Variant{"ufastslam", "closed", Association::nearest},
        Variant{"ufastslam", "closed", Association::known, 9, {{"map_uncertainty", "off"}}},
        Variant{"ufastslam", "ratio", Association::nearest, 8, {{"map_uncertainty", "off"}}},
        Variant{"ufastslam",
                "closed",
                Association::known,
                1,
                {{"alpha", "0.5"}, {"beta", "0"}, {"kappa", "1"}}}),
    testing::PrintToStringParamName());

}  // namespace
}  // namespace montecarta::filters
