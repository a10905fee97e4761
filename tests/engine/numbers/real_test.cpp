// SPDX-License-Identifier: BSD-3-Clause
#include "engine/numbers/real.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace montecarta::engine {
namespace {

template <std::size_t N>
void expect_directions() {
  RngStream draw({.seed = N, .purpose = Draw::test});
  for (int n = 0; n < 200; ++n) {
    std::array<double, N> angles;
    for (double& angle : angles) angle = 20.0 * draw.normal();
    const auto found = directions_of(angles);
    for (std::size_t k = 0; k < N; ++k) {
      EXPECT_NEAR(found[k].cosine, std::cos(angles[k]), 3e-16) << k << " of " << N;
      EXPECT_NEAR(found[k].sine, std::sin(angles[k]), 3e-16) << k << " of " << N;
      EXPECT_EQ(found[k].sine, direction_of(Lanes(angles[k])).sine.get(0)) << "same as in a lane";
    }
  }
}

TEST(Directions, AreThoseOfEachAngleWhateverTheOthersAre) {
  expect_directions<1>();
  expect_directions<2>();
  expect_directions<4>();
  expect_directions<5>();
  expect_directions<8>();
}

}  // namespace
}  // namespace montecarta::engine
