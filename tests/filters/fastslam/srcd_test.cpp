// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_filters.hpp"
#include "tests/filters/fastslam/filter_comparison.hpp"

namespace montecarta::filters {
namespace {

std::unique_ptr<SlamFilter> make_single(const Variant& v, const SmallWorldSettings& world) {
  const FilterSetup setup = setup_of(v, world);
  if (v.filter == "srcd_aided") return make_srcd_aided<double>(setup);
  return v.filter == "srcd" ? make_srcd<double>(setup) : make_srcd_pf<double>(setup);
}
std::unique_ptr<SlamFilter> make_reference(const Variant& v, const SmallWorldSettings& world) {
  return reference::make_srcd_fast_slam(
      reference_settings(v, world), reference_weight(v),
      reference::SrcdParts{.pose = v.filter != "srcd_aided",
                           .map = v.filter != "srcd_pf",
                           .map_uncertainty = !v.options.contains("map_uncertainty"),
                           .h = setup_of(v, world).options.number("interval")});
}

class SrcdFastSlams : public testing::TestWithParam<Variant> {};

TEST_P(SrcdFastSlams, LanesEqualOneParticleAtATime) {
  const SmallWorldSettings settings;
  const auto lanes = make_production(GetParam(), settings);
  const auto single = make_single(GetParam(), settings);
  expect_same_run(*lanes, *single, small_world(settings), 1e-10);
}

TEST_P(SrcdFastSlams, EqualsTheEigenReference) {
  const SmallWorldSettings settings;
  const auto lanes = make_production(GetParam(), settings);
  const auto plain = make_reference(GetParam(), settings);
  expect_same_run(*lanes, *plain, small_world(settings), 1e-8);
}

TEST_P(SrcdFastSlams, EstimatesBetweenScansAsTheReferenceDoes) {
  const SmallWorldSettings settings{.scans = 12};
  const auto lanes = make_production(GetParam(), settings);
  const auto plain = make_reference(GetParam(), settings);
  expect_same_steps(*lanes, *plain, small_world(settings), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(
    All, SrcdFastSlams,
    testing::Values(Variant{"srcd"}, Variant{"srcd", "ratio"},
                    Variant{"srcd", "closed", Association::nearest},
                    Variant{"srcd", "closed", Association::known, 1, {{"map_uncertainty", "off"}}},
                    Variant{"srcd", "closed", Association::known, 9, {{"interval", "1.3"}}},
                    Variant{"srcd_aided"}, Variant{"srcd_pf"},
                    Variant{"srcd_aided", "ratio", Association::nearest, 8},
                    Variant{
                        "srcd_pf", "ratio", Association::nearest, 9, {{"map_uncertainty", "off"}}}),
    testing::PrintToStringParamName());

}  // namespace
}  // namespace montecarta::filters
