// SPDX-License-Identifier: BSD-3-Clause
#include "engine/random/stream.hpp"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace montecarta::engine {
namespace {

TEST(Philox, EqualsPublishedTestVectors) {  // kat_vectors of Random123
  const std::array<std::uint64_t, 4> zeros{}, ones{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff};
  const std::array<std::uint64_t, 4> pi{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344};
  using Words = std::array<std::uint64_t, 4>;
  EXPECT_EQ(philox(zeros, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox(ones, {0xffffffff, 0xffffffff}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox(pi, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Philox, EqualsRandom123) {
  r123::Philox4x32 theirs;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const r123::Philox4x32::ctr_type counter{{i, i * 7919U, ~i, i << 16U}};
    const auto expected = theirs(counter, {{i * 31U, 5U}});
    const auto words =
        philox<std::uint64_t>({counter[0], counter[1], counter[2], counter[3]}, {i * 31U, 5U});
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(words[k], expected[k]) << "counter " << i;
  }
}

TEST(RngStream, IsAFunctionOfEveryPartOfItsIdentity) {
  const StreamIdentity identity{42, 7, 100, 3, Draw::test};
  RngStream a(identity), b(identity);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.bits(), b.bits());
  const std::vector<StreamIdentity> identities{
      {1, 1, 1, 1, Draw::test},          {2, 1, 1, 1, Draw::test},
      {1, 2, 1, 1, Draw::test},          {1, 1, 2, 1, Draw::test},
      {1, 1, 1, 2, Draw::test},          {1, 1, 1, 1, Draw::resampling},
      {1ULL << 32, 1, 1, 1, Draw::test}, {0, 0, 0, 0, Draw::world_control}};
  std::set<std::uint64_t> first;
  for (const auto& each : identities) first.insert(RngStream(each).bits());
  EXPECT_EQ(first.size(), identities.size());
}

TEST(RngStream, NormalHasTheRightMoments) {
  RngStream draw({20261121, 0, 0, 0, Draw::test});
  const int n = 400000;
  double sums[5] = {};
  for (int i = 0; i < n; ++i) {
    const double z = draw.normal();
    double power = 1.0;
    for (double& sum : sums) sum += (power *= z);
  }
  const double root = std::sqrt(n);  // tolerance: five standard errors of each moment
  EXPECT_NEAR(sums[0] / n, 0.0, 5 / root);
  EXPECT_NEAR(sums[1] / n, 1.0, 5 * std::sqrt(2.0) / root);
  EXPECT_NEAR(sums[2] / n, 0.0, 5 * std::sqrt(15.0) / root);
  EXPECT_NEAR(sums[3] / n, 3.0, 5 * std::sqrt(96.0) / root);
}

TEST(Normals, LanesEqualTheScalarStreams) {
  for (std::uint32_t step = 0; step < 200; ++step) {
    const StreamIdentity identity{0x123456789abcdefU, 5, step, 8 * step, Draw::pose_proposal};
    const Pair<Lanes> uniforms = uniform_pairs(identity, 1, Lanes());
    const Pair<Lanes> normals = normal_pairs<Lanes>(identity, 1);
    for (std::uint32_t i = 0; i < Lanes::kSize; ++i) {
      RngStream draw({identity.seed, 5, step, 8 * step + i, Draw::pose_proposal});
      draw.normal(), draw.normal();
      RngStream same = draw;
      EXPECT_EQ(uniforms.first.get(i), same.uniform());
      EXPECT_EQ(uniforms.second.get(i), same.uniform());
      EXPECT_NEAR(normals.first.get(i), draw.normal(), 1e-14);
      EXPECT_NEAR(normals.second.get(i), draw.normal(), 1e-14);
    }
  }
}

TEST(RngStream, UniformIsFlatAndOpen) {
  RngStream draw({3, 1, 4, 1, Draw::test});
  std::vector<int> counts(64, 0);
  const int n = 640000;
  for (int i = 0; i < n; ++i) {
    const double u = draw.uniform();
    ASSERT_GT(u, 0.0);
    ASSERT_LT(u, 1.0);
    ++counts[static_cast<std::size_t>(u * 64)];
  }
  double chi_square = 0.0;
  for (int count : counts) chi_square += (count - 10000.0) * (count - 10000.0) / 10000.0;
  EXPECT_LT(chi_square, 63 + 5 * std::sqrt(2.0 * 63));
}

TEST(RngStream, BelowIsFlat) {
  RngStream draw({3, 1, 4, 2, Draw::test});
  std::vector<int> counts(3, 0);
  for (int i = 0; i < 300000; ++i) ++counts[draw.below(3)];
  for (int count : counts) EXPECT_NEAR(count, 100000, 5 * std::sqrt(300000 * 2.0 / 9.0));
}

TEST(NormalTails, AreTheShareBeyond) {
  for (const double k : {0.0, 0.7, 2.0, 4.5}) {
    EXPECT_NEAR(normal_tails(k) / std::erfc(k / std::sqrt(2.0)), 1.0, 1e-15) << k;
  }
}

}  // namespace
}  // namespace montecarta::engine
