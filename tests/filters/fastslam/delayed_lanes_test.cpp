// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/delayed.hpp"
#include "tests/filters/fastslam/delayed_variants.hpp"

namespace montecarta::filters {
namespace {

class DelayedFilters : public testing::TestWithParam<Variant> {};

TEST_P(DelayedFilters, LanesEqualOneParticleAtATime) {
  const SmallWorldSettings settings{.scans = 60};
  const auto lanes = make_production(GetParam(), settings);
  const auto single = make_delayed<double>(setup_of(GetParam(), settings));
  expect_same_run(*lanes, *single, small_world(settings), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(
    All, DelayedFilters,
    testing::Values(delayed("4"), delayed("0", 9), delayed("5", 13, Association::nearest),
                    delayed("0", 8, Association::nearest),
                    Variant{"delayed",
                            "closed",
                            Association::known,
                            13,
                            {{"draw_every", "0"}, {"draw_beyond_deg", "0.5"}}}),
    testing::PrintToStringParamName());

}  // namespace
}  // namespace montecarta::filters
