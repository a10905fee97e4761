// SPDX-License-Identifier: BSD-3-Clause
#include "tests/experiments/commands/program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::StartsWith;

class Compare : public Program {
 protected:
  void SetUp() override {
    write("blink.ini", kBlink);
    write("blink.csv", kBlinkWorld);
    ASSERT_EQ(call({"run", "blink.ini", "-o", "out.h5", "--quiet"}).code, 0);
  }
};

TEST_F(Compare, SaysWhatEachCellHasMoreThanTheBaseline) {
  const Called called = call({"compare", "out.h5", "--baseline", "ekf_slam", "--csv", "tables"});
  EXPECT_EQ(called.code, 0) << called.err;
  for (const char* words : {"position_rmse [m]", "heading_rmse [rad]", "nees_distance",
                            "cpu_seconds [s]", "row beats", "on the Pareto front", "Holm"}) {
    EXPECT_THAT(called.out, HasSubstr(words));
  }
  EXPECT_THAT(text_of("tables/comparison.csv"), StartsWith("metric,units,cell,baseline,verdict,"));
  EXPECT_THAT(text_of("tables/wins.csv"), HasSubstr("\nposition_rmse,fastslam2_m10,ekf_slam,"));
  EXPECT_THAT(text_of("tables/pareto.csv"), HasSubstr("\nfastslam2_m10,"));
  const Called again = call({"compare", "out.h5", "--baseline", "ekf_slam", "--csv", "tables"});
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.err, HasSubstr("comparison.csv: is there already"));
}

TEST_F(Compare, TakesAnyMetricOfARun) {
  const Called called =
      call({"compare", "out.h5", "--baseline", "ekf_slam", "--metric", "position_error, nees"});
  EXPECT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(called.out, HasSubstr("position_error [m]"));
  EXPECT_THAT(called.out, testing::Not(HasSubstr("heading_rmse")));
}

TEST_F(Compare, NamesTheNearestSpelling) {
  const auto complaint = [&](const std::vector<std::string>& words) {
    const Called called = call(words);
    EXPECT_EQ(called.code, 2);
    return called.err;
  };
  EXPECT_THAT(complaint({"compare", "out.h5", "--baseline", "ekf_slan"}),
              HasSubstr("did you mean ekf_slam?"));
  EXPECT_THAT(complaint({"compare", "out.h5"}), ContainsRegex("--baseline CELL.*fastslam2_m10"));
  EXPECT_THAT(
      complaint({"compare", "out.h5", "--baseline", "ekf_slam", "--metric", "postion_rmse"}),
      HasSubstr("did you mean position_rmse?"));
}

}  // namespace
}  // namespace montecarta::experiments
