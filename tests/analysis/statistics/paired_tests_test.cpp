// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/paired_tests.hpp"

#include "engine/random/stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

TEST(SignTest, IsThatOfAFairCoin) {
  EXPECT_DOUBLE_EQ(sign_test(3, 7), 0.34375);  // 2 (1 + 10 + 45 + 120) / 1024
  EXPECT_DOUBLE_EQ(sign_test(7, 3), 0.34375);
  EXPECT_DOUBLE_EQ(sign_test(0, 20), std::ldexp(1.0, -19));
  EXPECT_NEAR(sign_test(450, 550), 0.0017305360849763024, 1e-15);  // SciPy's binomtest
  EXPECT_DOUBLE_EQ(sign_test(500, 501), 1.0);
  EXPECT_DOUBLE_EQ(sign_test(0, 0), 1.0);
}

// Darwin's maize in eighths of an inch, as Wilcoxon and Fisher discuss it: SciPy's wilcoxon.
TEST(SignedRankTest, IsExactOnDarwinsMaize) {
  const std::vector<double> maize = {6, 8, 14, 16, 23, 24, 28, 29, 41, -48, 49, 56, 60, -67, 75};
  const SignedRank test = signed_rank_test(maize);
  EXPECT_TRUE(test.is_exact);
  EXPECT_EQ(test.n, 15u);
  EXPECT_DOUBLE_EQ(test.negative, 24.0);
  EXPECT_DOUBLE_EQ(test.positive + test.negative, 120.0);
  EXPECT_DOUBLE_EQ(test.p, 0.041259765625);
}

TEST(SignedRankTest, SharesRanksOfTiesAndLeavesOutZeros) {
  const std::vector<double> pairs = {15, -7, 5, 20, 0, -9, 17, -12, 5, -10};
  const SignedRank test = signed_rank_test(pairs);
  EXPECT_FALSE(test.is_exact);
  EXPECT_EQ(test.n, 9u);
  EXPECT_DOUBLE_EQ(test.negative, 18.0);
  EXPECT_NEAR(test.p, 0.5936305914425295, 1e-14);
  EXPECT_DOUBLE_EQ(signed_rank_test({}).p, 1.0);
  EXPECT_DOUBLE_EQ(signed_rank_test(std::vector<double>{0.0, 0.0}).p, 1.0);
}

// Holm's procedure as every textbook works it: 0.01, 0.04, 0.03 and 0.005 times 3, 1, 2 and 4.
TEST(Holm, AdjustsATextbookFamily) {
  EXPECT_THAT(holm(std::vector<double>{0.01, 0.04, 0.03, 0.005}),
              ElementsAre(DoubleNear(0.03, 1e-15), DoubleNear(0.06, 1e-15), DoubleNear(0.06, 1e-15),
                          DoubleNear(0.02, 1e-15)));
  EXPECT_THAT(holm(std::vector<double>{0.6, 0.9}), ElementsAre(1.0, 1.0));
  EXPECT_THAT(holm(std::vector<double>{}), ElementsAre());
}

/// Share of 2000 studies of `runs` pairs without difference that `p_of` calls different at 5 %.
template <class P>
double false_calls(std::size_t runs, P p_of) {
  RngStream draw({.seed = 8, .purpose = Draw::test});
  std::size_t calls = 0;
  for (int study = 0; study < 2000; ++study) {
    std::vector<double> differences(runs);
    for (double& d : differences) d = draw.normal();
    calls += p_of(differences) < 0.05 ? 1u : 0u;
  }
  return static_cast<double>(calls) / 2000.0;
}

// At most 5 %, five standard errors allowed; and near it where the distribution is fine enough.
TEST(PairedTests, KeepTheirLevel) {
  const double error = std::sqrt(0.05 * 0.95 / 2000.0);
  const auto rank = [](const std::vector<double>& d) { return signed_rank_test(d).p; };
  const auto sign = [](const std::vector<double>& d) {
    const auto won =
        static_cast<std::size_t>(std::ranges::count_if(d, [](double v) { return v < 0; }));
    return sign_test(won, d.size() - won);
  };
  for (const std::size_t runs : {20u, 50u, 51u, 200u}) {
    EXPECT_NEAR(false_calls(runs, rank), 0.05, 5.0 * error) << runs;
    EXPECT_LT(false_calls(runs, sign), 0.05 + 5.0 * error) << runs;
  }
}

}  // namespace
}  // namespace montecarta::analysis
