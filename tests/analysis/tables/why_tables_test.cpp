// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/tables/why_tables.hpp"

#include "analysis/statistics/means.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

namespace montecarta {
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
  cell.anatomy = anatomy;
  cell.credibility = Credibility{6.0, -5.5};
  return cell;
}

TEST(WhyTable, NamesTheWorstDirection) {
  const TextTable table = why_table(study_of(explained()));
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_THAT(table.rows[0], ElementsAre("srcd_m10", "9.00", testing::_, "heading 97 %", "25.0 %",
                                         "6.00 dB", "-5.50 dB", "-"));
  EXPECT_EQ(table.rows[0].size(), table.headings.size());
}

TEST(WhyTable, SaysWhatFewParticlesCost) {
  CellAnalysis cell = explained();
  cell.lineages = LineageSummary{};
  cell.lineages->monte_carlo_share = 0.125;
  EXPECT_EQ(why_table(study_of(cell)).rows[0].back(), "12.5 %");
}

TEST(InnovationTable, ShowsTheLagThatIsWorst) {
  CellAnalysis cell;
  Innovations found;
  found.mean = 1.25;
  found.interval = {1.2, 1.3};
  found.share_inside = 0.5;
  found.autocorrelation.assign(kInnovationLags, 0.01);
  found.autocorrelation[4] = -0.2;
  found.bound = 0.05;
  cell.innovations = found;
  const TextTable table = innovation_table(study_of(cell));
  EXPECT_THAT(table.rows[0], ElementsAre("srcd_m10", "1.250 [1.200, 1.300]", "50.0 %", "0.0100",
                                         "-0.200 at 5", "0.0500", "not white"));
  EXPECT_EQ(table.rows[0].size(), table.headings.size());
}

TEST(DiversityTable, LeavesOpenWhatIsNotStored) {
  const auto kept = std::make_unique<CellAnalysis>();  // on the stack g++ 12 takes it for unset
  CellAnalysis& cell = *kept;
  cell.scores.add(std::vector<ScoreTable::Value>{{"ess", 5.0}, {"resampling_rate", 0.5}});
  cell.scan_series = {{"ess", "1", {5.0}}};
  const TextTable without = diversity_table(study_of(cell));
  EXPECT_THAT(without.rows[0], ElementsAre("srcd_m10", "5.00", "50.0 %", "-", "-", "-", "-", "-"));
  cell.lineages = LineageSummary{};
  cell.lineages->ancestors.fill(2.0);
  cell.lineages->coalescence = kNaN;
  cell.lineages->coalesced_share = 0.0;
  EXPECT_THAT(diversity_table(study_of(cell)).rows[0],
              ElementsAre("srcd_m10", "5.00", "50.0 %", "2.00", "2.00", "2.00", "-", "0.0 %"));
  EXPECT_EQ(without.rows[0].size(), without.headings.size());
}

TEST(WhyTables, HaveNoRowsWhereNothingIsKnown) {
  const StudyAnalysis study = study_of({});
  EXPECT_TRUE(why_table(study).rows.empty());
  EXPECT_TRUE(innovation_table(study).rows.empty());
  EXPECT_TRUE(diversity_table(study).rows.empty());
}

}  // namespace
}  // namespace montecarta
