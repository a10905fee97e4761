// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/cell_comparison.hpp"
#include "analysis/metrics/cell_sums.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

TEST(FirstValues, AreThoseOfTheAnalysis) {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 10, 80);
  const ResultFile file(folder / "out.h5");
  const StudyAnalysis study = analyze(file);
  for (const std::string name : {"position_rmse", "nees_distance"}) {
    const Score& score = *find_score(name);
    for (std::size_t c = 0; c < 2; ++c) {
      const auto values = first_values(file, file.cells()[c], score, 7, Parallel(Backend::tbb, 2));
      ASSERT_EQ(values.size(), 7u);
      for (std::size_t i = 0; i < 7; ++i)
        EXPECT_EQ(values[i], study.cells[c].scores.column(score.name)[i]);
    }
  }
  const auto all =
      first_values(file, file.cells()[1], *find_score("position_rmse"), 10, Parallel::serial());
  EXPECT_EQ(all.size(), 9u) << "the failed run has none";
}

// 1, 2, 3: sd 1, standard error 1 / sqrt 3, and 4.302652730 is the 97.5 % quantile of t with 2.
TEST(HalfWidth, IsStudents) {
  EXPECT_NEAR(half_width({1.0, 2.0, 3.0}, 0.95), 4.302652729911275 / std::sqrt(3.0), 1e-9);
  EXPECT_EQ(half_width({1.0}, 0.95), HUGE_VAL);
  EXPECT_TRUE(std::isnan(half_width({1.0, NAN, 2.0}, 0.95)));
}

}  // namespace
}  // namespace montecarta::analysis
