// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/gate.hpp"

#include "engine/errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// A verdict on the average over the run alone, within 1.2.
Consistency found_by_average(Verdict verdict, const Interval& ratio) {
  Consistency found;
  found.verdict = verdict;
  found.runs = 40;
  found.within = 1.2;
  found.ratio = ratio;
  found.mean = 3.0 * std::sqrt(ratio.lower * ratio.upper);
  found.average_bounds = {found.mean / ratio.upper, found.mean / ratio.lower};
  return found;
}

TEST(Gate, LetsAConsistentFilterPass) {
  const Gate found = gate(found_by_average(Verdict::consistent, {0.97, 1.08}));
  EXPECT_EQ(found.answer, GateAnswer::consistent);
  EXPECT_EQ(found.why,
            "consistent within 1.2; ANEES 0.970 to 1.08 times the expected one, 40 runs");
}

TEST(Gate, StopsAFilterThatIsOff) {
  const Gate optimistic = gate(found_by_average(Verdict::optimistic, {1.3, 1.6}));
  EXPECT_EQ(optimistic.answer, GateAnswer::inconsistent);
  EXPECT_THAT(optimistic.why, StartsWith("not consistent, optimistic by 1.30 to 1.60; ANEES"));
  const Gate conservative = gate(found_by_average(Verdict::conservative, {0.5, 0.7}));
  EXPECT_EQ(conservative.answer, GateAnswer::inconsistent);
  EXPECT_THAT(conservative.why, Not(HasSubstr("may lie")));
}

// Shown to differ from 1, not by how much: more runs may find it within the margin.
TEST(Gate, SaysWhereTheMarginIsNotLeft) {
  const Gate found = gate(found_by_average(Verdict::optimistic, {1.02, 1.3}));
  EXPECT_EQ(found.answer, GateAnswer::inconsistent);
  EXPECT_THAT(found.why, HasSubstr("optimistic by 1.02 to 1.30, though it may lie within 1.2"));
}

TEST(Gate, WaitsWhereNothingIsKnown) {
  Consistency open = found_by_average(Verdict::undecided, {0.8, 1.3});
  open.more_runs = 130;
  const Gate found = gate(open);
  EXPECT_EQ(found.answer, GateAnswer::undecided);
  EXPECT_THAT(found.why, HasSubstr("undecided: 130 more runs decide; ANEES 0.800 to 1.30"));
  EXPECT_THAT(gate(found_by_average(Verdict::undecided, {0.0, HUGE_VAL})).why,
              HasSubstr("undecided: too few runs; 40 runs"));
}

TEST(Gate, StopsAFilterWhoseRunsFail) {
  Consistency good = found_by_average(Verdict::consistent, {0.97, 1.08});
  good.failed = 2;
  const Gate found = gate(good);
  EXPECT_EQ(found.answer, GateAnswer::inconsistent);
  EXPECT_THAT(found.why, HasSubstr("(2 of 40 runs failed)"));
  EXPECT_EQ(gate(good, {.failed = 1}).answer, GateAnswer::inconsistent);
  const Gate tolerant = gate(good, {.failed = 2});
  EXPECT_EQ(tolerant.answer, GateAnswer::consistent);
  EXPECT_THAT(tolerant.why, StartsWith("consistent within 1.2 in what can be judged (2 of 40"));
}

TEST(Gate, StopsAFilterWhoseSamplesAreUnusable) {
  Consistency good = found_by_average(Verdict::consistent, {0.97, 1.08});
  good.samples = 600;
  good.unusable = 30;
  EXPECT_EQ(gate(good).answer, GateAnswer::inconsistent);
  EXPECT_EQ(gate(good, {.failed = 600, .unusable = 29}).answer, GateAnswer::inconsistent);
  const Gate tolerant = gate(good, {.unusable = 30});
  EXPECT_EQ(tolerant.answer, GateAnswer::consistent);
  EXPECT_THAT(tolerant.why, HasSubstr("(30 of 600 samples are unusable)"));
}

TEST(Gate, StopsAFilterOfWhichNoRunIsComplete) {
  Consistency none;
  none.runs = none.failed = 20;
  EXPECT_EQ(gate(none).answer, GateAnswer::inconsistent);
}

TEST(Gate, RefusesWhatWasNotJudged) { EXPECT_THROW(gate({}), StudyError); }

}  // namespace
}  // namespace montecarta::analysis
