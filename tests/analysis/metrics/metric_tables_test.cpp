// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/error_anatomy.hpp"
#include "analysis/metrics/innovations.hpp"
#include "analysis/metrics/lineages.hpp"
#include "analysis/statistics/spread.hpp"
#include "tests/analysis/reported.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;

StudyAnalysis study_of(CellAnalysis cell) {
  StudyAnalysis study;
  cell.label = "srcd_m10";
  cell.complete = 30;
  study.cells = {std::move(cell)};
  return study;
}

CellAnalysis explained() {
  CellAnalysis cell;
  ErrorAnatomy anatomy;
  anatomy.mean_worst_ratio = 9.0;
  anatomy.worst_direction = {0.02, 0.01, 0.97};
  anatomy.mean_bias_share = 0.25;
  cell.findings.put(anatomy);
  return cell;
}

TEST(ErrorAnatomyTable, NamesTheWorstDirection) {
  const TextTable table = reported_table(study_of(explained()), "error_anatomy");
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_THAT(table.rows[0],
              ElementsAre("srcd_m10", "9.00", testing::_, "heading 97 %", "25.0 %", "-"));
  EXPECT_EQ(table.rows[0].size(), table.headings.size());
}

TEST(ErrorAnatomyTable, SaysWhatFewParticlesCost) {
  CellAnalysis cell = explained();
  LineageSummary lineages;
  lineages.monte_carlo_share = 0.125;
  cell.findings.put(lineages);
  EXPECT_EQ(reported_table(study_of(cell), "error_anatomy").rows[0].back(), "12.5 %");
}

TEST(InnovationTable, ShowsTheLagThatIsWorst) {
  CellAnalysis cell;
  Innovations found;
  found.mean = 1.25;
  found.interval = {1.2, 1.3};
  found.share_inside = 0.5;
  found.autocorrelation.assign(kInnovationLags, 0.01);
  found.autocorrelation[4] = -0.2;
  found.white_bound.assign(kInnovationLags, 0.05);
  found.worst_lag = 5;
  cell.findings.put(found);
  const TextTable table = reported_table(study_of(cell), "innovations");
  EXPECT_THAT(table.rows[0], ElementsAre("srcd_m10", "1.250 [1.200, 1.300]", "50.0 %", "0.0100",
                                         "-0.200 at 5", "0.0500", "not white"));
  EXPECT_EQ(table.rows[0].size(), table.headings.size());
}

TEST(DiversityTable, LeavesOpenWhatIsNotStored) {
  const auto kept = std::make_unique<CellAnalysis>();  // on the stack g++ 12 takes it for unset
  CellAnalysis& cell = *kept;
  cell.scores.add(std::vector<ScoreTable::Value>{{"ess", 5.0}, {"resampling_rate", 0.5}});
  cell.scan_series = {{"ess", "1", {5.0}}};
  const TextTable without = reported_table(study_of(cell), "diversity");
  EXPECT_THAT(without.rows[0], ElementsAre("srcd_m10", "5.00", "50.0 %", "-", "-", "-", "-", "-"));
  LineageSummary lineages;
  lineages.ancestors.fill(2.0);
  lineages.coalescence = kNaN;
  cell.findings.put(lineages);
  EXPECT_THAT(reported_table(study_of(cell), "diversity").rows[0],
              ElementsAre("srcd_m10", "5.00", "50.0 %", "2.00", "2.00", "2.00", "-", "0.0 %"));
  EXPECT_EQ(without.rows[0].size(), without.headings.size());
}

TEST(MetricTables, HaveNoRowsWhereNothingIsKnown) {
  const auto nothing = std::make_unique<CellAnalysis>();  // on the stack g++ 12 takes it for unset
  const StudyAnalysis study = study_of(*nothing);
  EXPECT_TRUE(reported_table(study, "error_anatomy").rows.empty());
  EXPECT_TRUE(reported_table(study, "innovations").rows.empty());
  EXPECT_TRUE(reported_table(study, "diversity").rows.empty());
}

}  // namespace
}  // namespace montecarta::analysis
