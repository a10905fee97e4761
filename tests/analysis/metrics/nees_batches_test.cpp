// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/nees_batches.hpp"

#include "analysis/metrics/cell_sums.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

const std::vector<double> kBatchTimes = {0.2, 0.4, 0.6};

/// A run whose NEES of the pose and of the position are these, that of the heading 0.
RunRows run_of_nees(const std::vector<double>& nees) {
  RunRows rows;
  for (const double value : nees) {
    const std::vector<double> truth = {std::sqrt(value), 0.0, 0.0};
    rows.truth.insert(rows.truth.end(), truth.begin(), truth.end());
    rows.spread.mean.insert(rows.spread.mean.end(), 3, 0.0);
    const std::vector<double> identity = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    rows.spread.covariance.insert(rows.spread.covariance.end(), identity.begin(), identity.end());
  }
  return rows;
}

NeesBatches batches_of_runs(const std::vector<std::vector<double>>& runs, const Printed& printed) {
  const RunCriteria criteria{.times = kBatchTimes,
                             .references = {},
                             .beacons = {},
                             .map = {},
                             .joint_scans = {},
                             .walks = BandWalks(kBatchTimes.size()),
                             .printed = printed};
  CellSums sums(criteria);
  MeasuredRun measured;
  for (const std::vector<double>& nees : runs) {
    measured.rows = run_of_nees(nees);
    measured.measure(criteria, 0);
    sums.add(measured);
  }
  CellAnalysis cell;
  sums.put(cell);
  return cell.get<NeesBatches>();
}

// Batches of two: averages 2, 5, 9 and 9, 2, 2; the fifth run fills none. The expected band of two
// runs of three components is [0.62, 7.22].
TEST(NeesBatches, KnowsTwoBatchesByHand) {
  Printed printed;
  printed.runs = 2;
  printed.bands = {{"pose", 2.19, 3.93}};
  const NeesBatches found =
      batches_of_runs({{1, 4, 8}, {3, 6, 10}, {9, 2, 1}, {9, 2, 3}, {50, 50, 50}}, printed);
  EXPECT_EQ(found.runs, 2u);
  const BlockBatches* const pose = found.find(ErrorBlock::pose);
  ASSERT_NE(pose, nullptr);
  EXPECT_EQ(pose->by_printed.stays_above_from, (std::vector<double>{0.4, HUGE_VAL}));
  EXPECT_EQ(pose->by_printed.share_above, (std::vector<double>{2.0 / 3.0, 1.0 / 3.0}));
  EXPECT_EQ(pose->by_printed.share_inside, (std::vector<double>{0.0, 0.0}));
  EXPECT_EQ(pose->by_expected.stays_above_from, (std::vector<double>{0.6, HUGE_VAL}));
  EXPECT_EQ(pose->by_expected.share_inside, (std::vector<double>{2.0 / 3.0, 2.0 / 3.0}));
  ASSERT_NE(found.find(ErrorBlock::position), nullptr);
  EXPECT_TRUE(found.find(ErrorBlock::position)->by_printed.share_inside.empty());
}

TEST(NeesBatches, AreNoneWhereNoPaperSaysOfHowManyRuns) {
  EXPECT_TRUE(batches_of_runs({{1, 1, 1}, {1, 1, 1}}, {}).blocks.empty());
}

}  // namespace
}  // namespace montecarta::analysis
