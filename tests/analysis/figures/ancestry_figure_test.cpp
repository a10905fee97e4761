// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/ancestry_figure.hpp"

#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

using testing::HasSubstr;

TEST(AncestryFigure, HasATreeForEveryCellThatCompletedTheRun) {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 4, 120);
  const ResultFile file(folder / "out.h5");
  const Figure figure = ancestry_figure(file, 0);
  ASSERT_EQ(figure.data.size(), 2u);
  EXPECT_EQ(figure.data[0].name, "ancestry_scripted_m4.csv");
  EXPECT_GE(figure.data[0].rows.size(), 4u);  // a line a leaf at least
  for (const auto& row : figure.data[0].rows) {
    EXPECT_LE(row[0], row[1]);
    EXPECT_LE(row[1], file.scan_times().back());
  }
  ASSERT_EQ(figure.chart.panels.size(), 2u);
  EXPECT_EQ(figure.chart.panels[1].cell, "scripted_m3");
  EXPECT_EQ(figure.chart.panels[0].marks.at(0).x.size(), 4 * figure.data[0].rows.size());
  EXPECT_LT(figure.chart.x_first, file.scan_times().back());
  EXPECT_THAT(figure.sentence, HasSubstr("Run 0:"));
  EXPECT_EQ(ancestry_figure(file, 3).data.size(), 1u);  // scripted_m3 failed in run 3
}

TEST(AncestryFigure, IsNotWhereNoAncestryIsStored) {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 2, 40, {},
                         [](StudyPlan& plan) { plan.columns.ancestry = false; });
  EXPECT_TRUE(ancestry_figure(ResultFile(folder / "out.h5"), std::nullopt).data.empty());
}

}  // namespace
}  // namespace montecarta::analysis
