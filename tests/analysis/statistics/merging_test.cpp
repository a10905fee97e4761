// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/merging.hpp"

#include "analysis/statistics/spread.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;

struct Inner {
  double sum = 0.0;
  static constexpr auto parts() { return std::tuple(added(&Inner::sum)); }
};

struct Outer {
  int runs = 0;
  std::vector<Inner> scans = {};
  std::optional<Inner> known = {};
  std::vector<int> values = {}, kept = {};
  std::vector<std::vector<int>> lists = {};
  std::optional<int> first = {};
  int setting = 0;

  std::size_t most() const { return 3; }
  static constexpr auto parts() {
    return std::tuple(added(&Outer::runs, &Outer::scans, &Outer::known),
                      appended(&Outer::values, &Outer::lists),
                      appended_up_to(&Outer::most, &Outer::kept), of_first_run(&Outer::first));
  }
};

TEST(Merging, TreatsEveryMemberAsWhatItIs) {
  Outer sums{
      .runs = 1, .scans = {{1.0}}, .values = {1}, .kept = {1, 2}, .lists = {{1}, {}}, .setting = 7};
  const Outer next{.runs = 2,
                   .scans = {{10.0}, {20.0}},
                   .known = Inner{5.0},
                   .values = {2, 3},
                   .kept = {3, 4},
                   .lists = {{2}, {3}},
                   .first = 4,
                   .setting = 8};
  Outer used_up = next;
  merge_into(sums, used_up);
  EXPECT_EQ(sums.runs, 3);
  ASSERT_EQ(sums.scans.size(), 2U);
  EXPECT_EQ(sums.scans[0].sum, 11.0);
  EXPECT_EQ(sums.scans[1].sum, 20.0);
  EXPECT_EQ(sums.known->sum, 5.0);
  EXPECT_THAT(sums.values, ElementsAre(1, 2, 3));
  EXPECT_THAT(sums.lists, ElementsAre(ElementsAre(1, 2), ElementsAre(3)));
  EXPECT_THAT(sums.kept, ElementsAre(1, 2, 3));
  EXPECT_EQ(sums.first, 4);
  EXPECT_EQ(sums.setting, 7);
  used_up = next;
  merge_into(sums, used_up);
  EXPECT_EQ(sums.known->sum, 10.0);
  EXPECT_EQ(sums.kept.size(), 3U);
  EXPECT_EQ(sums.first, 4);
}

TEST(Merging, IntoEmptyListsKeepsAsManyOfTheFirstRunsAsBefore) {
  Outer sums, next{.values = {1, 2}, .kept = {1, 2, 3, 4}};
  merge_into(sums, next);
  EXPECT_THAT(sums.values, ElementsAre(1, 2));
  EXPECT_THAT(sums.kept, ElementsAre(1, 2, 3));
}

TEST(Merging, OfSummariesIsThatOfAllValues) {
  SummaryOf all, parts[3];
  for (int k = 0; k < 30; ++k) {
    const double value = 1e3 + std::sin(k);
    all.add(value);
    parts[k < 13 ? 0 : 1].add(value);
  }
  merge_into(parts[0], parts[1]);
  merge_into(parts[0], parts[2]);  // of nothing
  EXPECT_EQ(parts[0].result().n, 30U);
  EXPECT_NEAR(parts[0].result().mean, all.result().mean, 1e-12);
  EXPECT_NEAR(parts[0].result().sd, all.result().sd, 1e-12);
  SummaryOf none;
  none.merge(all);
  EXPECT_EQ(none.result().mean, all.result().mean);
  EXPECT_EQ(none.result().sd, all.result().sd);
}

}  // namespace
}  // namespace montecarta::analysis
