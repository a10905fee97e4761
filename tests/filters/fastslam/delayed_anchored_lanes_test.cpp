// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/delayed.hpp"
#include "tests/filters/fastslam/delayed_variants.hpp"

namespace montecarta {
namespace {

class DelayedAnchoredFilters : public testing::TestWithParam<Variant> {};

TEST_P(DelayedAnchoredFilters, LanesEqualOneParticleAtATime) {
  const SmallWorldSettings settings = rough_small_world(60);
  const auto lanes = make_production(GetParam(), settings);
  const FilterSetup setup = setup_of(GetParam(), settings);
  const auto single = GetParam().filter == "delayed"
                          ? make_delaying<double>(setup, Linearised(), Anchored())
                          : make_delaying<double>(setup, delayed_srcd_points(setup), Anchored());
  expect_same_run(*lanes, *single, small_world(settings), 1e-9);
}

Variant by_central_differences(const char* every, std::size_t particles, Association association) {
  Variant variant = anchored(delayed(every, particles, association));
  variant.filter = "delayed_srcd";
  return variant;
}

INSTANTIATE_TEST_SUITE_P(All, DelayedAnchoredFilters,
                         testing::Values(anchored(delayed("4")),
                                         anchored(delayed("5", 13, Association::nearest)),
                                         anchored(delayed("0", 8, Association::nearest)),
                                         by_central_differences("6", 13, Association::known),
                                         by_central_differences("6", 5, Association::nearest),
                                         by_central_differences("0", 9, Association::known)),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace montecarta
