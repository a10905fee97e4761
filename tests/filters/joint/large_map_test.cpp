// SPDX-License-Identifier: BSD-3-Clause
// A map so large that most of it is compressed.
#include "filters/joint/joint_filter.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

// A vehicle goes round once and a half and sees a twentieth of the map at a time.
TEST(LargeMap, IsSearchedAsIfNobodyHadCompressedIt) {
  const SmallWorldSettings settings{
      .seed = 41, .landmarks = 300, .scans = 430, .max_range = 11.0, .noise = fine()};
  const SmallWorld world = small_world(settings);
  const auto knowing = make_filter(ekf_slam_kind(), settings);
  const auto expected = estimates_of(*knowing, world);
  const auto searching = make_filter(ekf_slam_kind(), settings, {}, Association::nearest);
  double wrong = 0.0;
  drive_through(*searching, world, {}, [&](std::size_t s) {
    wrong += searching->report().association.wrong + searching->report().association.new_again;
    EXPECT_LT(boxminus(searching->estimate().spread.mean, expected[s].mean).norm(), 0.01)
        << "scan " << s << ": one detection in twenty lies outside the gate";
  });
  EXPECT_EQ(wrong, 0.0) << "landmarks lie far apart in this noise";
  EXPECT_GT(searching->report().map_size, 190.0);
}

}  // namespace
}  // namespace montecarta::filters
