// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/verdict.hpp"

#include "engine/errors.hpp"
#include "tests/doubles/matchers.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

/// A member with one interval for everything; its p-value follows from whether that holds 1 or 0.
Member member(Family family, const std::string& name, const Interval& interval) {
  const double right = is_ratio(family) ? 1.0 : 0.0;
  Member one{.name = name};
  one.estimate = is_ratio(family) ? std::sqrt(interval.lower * interval.upper)
                                  : 0.5 * (interval.lower + interval.upper);
  one.interval = one.simultaneous = interval;
  one.p = interval.lower > right || interval.upper < right ? 1e-6 : 0.5;
  return one;
}

FamilyTest family(Family which, const std::vector<std::pair<std::string, Interval>>& members) {
  FamilyTest test{.family = which};
  for (const auto& [name, interval] : members)
    test.members.push_back(member(which, name, interval));
  return test;
}

FamilyTest size(const Interval& interval) { return family(Family::size, {{"all", interval}}); }

/// Eight stretches of 10 s with these intervals.
FamilyTest stretches(const std::vector<Interval>& intervals) {
  FamilyTest test{.family = Family::stretch};
  for (std::size_t s = 0; s < intervals.size(); ++s) {
    test.members.push_back(member(Family::stretch, "", intervals[s]));
    test.members.back().from = 10.0 * static_cast<double>(s);
    test.members.back().to = 10.0 * static_cast<double>(s + 1);
  }
  return test;
}

Verdict judged(std::vector<FamilyTest> families, double within = 1.1) {
  judge_together(families, 0.95);
  return judge(std::move(families), 0.95, within, 200);
}

const Interval kRight = {0.95, 1.05};

TEST(Judge, CallsConsistentWhatIsShownToBeWithinEveryMargin) {
  EXPECT_EQ(judged({size(kRight)}).answer, Answer::consistent);
  EXPECT_EQ(judged({size({0.85, 1.05})}).answer, Answer::undecided);
  EXPECT_EQ(judged({size(kRight), stretches({kRight, {0.9, 1.2}})}).answer, Answer::undecided);
  EXPECT_EQ(judged({size(kRight), stretches({kRight, {0.9, 1.2}})}, 1.3).answer,
            Answer::consistent);
  const auto with_bias = [](double most) {
    return judged({size(kRight), family(Family::bias, {{"heading", {-0.1, most}}})}).answer;
  };
  EXPECT_EQ(with_bias(0.31), Answer::consistent) << "sqrt(0.1) is 0.316";
  EXPECT_EQ(with_bias(0.32), Answer::undecided);
  const auto with_correlation = [](double most) {
    const FamilyTest test = family(Family::correlation, {{"a and b", {-0.05, most}}});
    return judged({size(kRight), test}).answer;
  };
  EXPECT_EQ(with_correlation(0.099), Answer::consistent);
  EXPECT_EQ(with_correlation(0.101), Answer::undecided);
}

// Scans and the spread between runs are not proved to be within the margin, only not disproved.
TEST(Judge, AllowsWhatIsNotShownToBeBeyondTheMargin) {
  const auto with_scan = [](const Interval& scan) {
    return judged({size(kRight), family(Family::scan, {{"at 1 s", scan}})}).answer;
  };
  EXPECT_EQ(with_scan({0.7, 1.5}), Answer::consistent);
  EXPECT_EQ(with_scan({1.05, 1.5}), Answer::consistent) << "off, but within the margin";
  EXPECT_EQ(with_scan({1.15, 1.5}), Answer::optimistic);
  const auto with_spread = [](const Interval& spread) {
    return judged({size(kRight), family(Family::between_runs, {{"runs", spread}})}).answer;
  };
  EXPECT_EQ(with_spread({0.05, 0.3}), Answer::consistent);
  EXPECT_EQ(with_spread({0.15, 0.3}), Answer::inconsistent);
}

TEST(Judge, NeedsTheSizeForConsistencyAndTellsTheDirection) {
  EXPECT_EQ(judged({family(Family::scan, {{"at 1 s", kRight}})}).answer, Answer::undecided);
  EXPECT_EQ(judged({}).answer, Answer::untested);
  const auto components = [](const Interval& one, const Interval& other) {
    return judged({size({0.8, 1.3}), family(Family::component, {{"a", one}, {"b", other}})});
  };
  EXPECT_EQ(components({1.9, 2.1}, {0.9, 1.1}).answer, Answer::optimistic);
  EXPECT_EQ(components({0.4, 0.6}, {0.9, 1.1}).answer, Answer::conservative);
  EXPECT_EQ(components({0.4, 0.6}, {1.9, 2.1}).answer, Answer::inconsistent);
}

TEST(Judge, SaysHowManyRunsDecide) {
  const Verdict found = judged({size({1.0 / 1.1, 1.1})}, 1.05);
  ASSERT_TRUE(found.more_runs);
  const double growth = std::pow(2.0 * std::log(1.1) / std::log(1.05), 2);
  EXPECT_NEAR(static_cast<double>(*found.more_runs), 200.0 * (growth - 1.0), 1.0);
  EXPECT_FALSE(judged({size({0.9, HUGE_VAL})}).more_runs);
  EXPECT_FALSE(judged({size(kRight)}).more_runs) << "it is decided";
  std::vector<FamilyTest> few = {size({0.5, 2.0})};
  judge_together(few, 0.95);
  EXPECT_EQ(judge(few, 0.95, 1.1, 12).more_runs, 8u) << "of less than 20 it is not known";
}

TEST(JudgeTogether, CorrectsForMembersAndFamilies) {
  FamilyTest one = size({0.9, 1.1}), two = stretches({kRight, kRight, kRight, kRight});
  one.members[0].p = 0.03;
  two.members[2].p = 0.005;
  std::vector<FamilyTest> families = {one, two};
  judge_together(families, 0.95);
  EXPECT_DOUBLE_EQ(families[1].p, 0.04) << "Bonferroni over 4 members, Holm over 2 families";
  EXPECT_DOUBLE_EQ(families[0].p, 0.04) << "not less than that of the family before";
  EXPECT_TRUE(families[1].is_shown(families[1].members[2]));
  EXPECT_FALSE(families[1].is_shown(families[1].members[1]));
}

TEST(Words, SayHowMuchWhenAndWhere) {
  const Interval off = {1.4, 2.4};
  const FamilyTest components = family(
      Family::component, {{"forward", {3.0, 4.0}}, {"left", {1.1, 1.6}}, {"heading", {1.0, 1.7}}});
  const Verdict late =
      judged({size({1.28, 2.25}), components, stretches({kRight, kRight, off, off})});
  EXPECT_EQ(in_words(late), "optimistic: NEES 1.28 to 2.25 times too large, from 20.0 s on");
  EXPECT_EQ(sentence("ekf_slam", late),
            "ekf_slam is optimistic (overconfident): on average its squared errors are 1.70 times "
            "what it claims (95 %: 1.28 to 2.25), shown from 20.0 s on, mainly forward.");
  EXPECT_EQ(sentence("ukf", judged({size({0.125, 0.25})})),
            "ukf is conservative: on average its squared errors are 5.66 times smaller than it "
            "claims (95 %: 4.00 to 8.00).");
  EXPECT_EQ(in_words(judged({size({0.125, 0.25})})),
            "conservative: NEES 4.00 to 8.00 times too small");
  EXPECT_THAT(sentence("a", judged({size(kRight), stretches({kRight, off, kRight, kRight})})),
              HasSubstr("its squared errors from 10.0 s to 20.0 s are 1.40 to 2.40 times"));
}

TEST(Words, NameWhatIsOffWhereTheSizeIsRight) {
  const auto words = [](const FamilyTest& test) {
    return in_words(judged({size({0.9, 1.2}), test}));
  };
  EXPECT_EQ(words(family(Family::component, {{"heading", {1.9, 2.1}}, {"left", kRight}})),
            "optimistic: NEES 1.90 to 2.10 times too large in heading");
  EXPECT_EQ(words(family(Family::component, {{"heading", {1.9, 2.1}}, {"left", {0.4, 0.5}}})),
            "inconsistent: NEES 1.90 to 2.10 times too large in heading, 2.00 to 2.50 times too "
            "small left");
  EXPECT_EQ(words(family(Family::bias, {{"forward", {-0.5, -0.3}}})),
            "inconsistent: a bias forward of 0.300 to 0.500 standard deviations");
  EXPECT_EQ(words(family(Family::correlation, {{"a and b", {0.4, 0.6}}})),
            "inconsistent: a correlation of 0.400 to 0.600 between a and b that is not reported");
  EXPECT_THAT(words(family(Family::between_runs, {{"runs", {0.3, 0.6}}})),
              HasSubstr("scales of their own in single runs"));
}

TEST(Words, SaySlightDeviationsAndWhatIsNotExcluded) {
  const Verdict found = judged({size({1.02, 1.06})});
  EXPECT_EQ(in_words(found), "consistent within 1.1, slightly optimistic (1.02 to 1.06)");
  EXPECT_EQ(sentence("smoother", judged({size(kRight), stretches({kRight, kRight})})),
            "smoother is consistent within 1.1 in every component and in every eighth of the "
            "drive; events rarer than 1 in 66 runs are not excluded.");
  Verdict open = judged({size({0.8, 1.3})});
  open.more_runs = 130;
  EXPECT_EQ(in_words(open), "undecided: about 130 more runs decide");
  open.more_runs.reset();
  EXPECT_EQ(in_words(open), "undecided: many more runs decide");
  open.runs = 1;
  EXPECT_EQ(in_words(open), "undecided: take at least 20 runs");
  EXPECT_THAT(sentence("a", open), HasSubstr("1 run does not show whether"));
  EXPECT_EQ(in_words(Verdict{}), "not tested");
}

TEST(Words, SayWhatFailedAndKnowErrorsOfZero) {
  EXPECT_EQ(in_words(judged({size(kRight), family(Family::scan, {{"at 1 s", {1.05, 1.5}}})})),
            "consistent within 1.1");
  EXPECT_EQ(in_words(judged({size({0.0, 0.0})})),
            "conservative: NEES infinitely many times too small");
  Verdict found = judged({size(kRight)});
  found.failed = 3;
  found.samples = 600;
  found.unusable = 30;
  EXPECT_EQ(in_words(found),
            "consistent within 1.1 in what can be judged (3 of 200 runs failed, 30 of 600 samples "
            "are unusable)");
}

TEST(Gate, AnswersByVerdict) {
  EXPECT_EQ(gate(judged({size(kRight)})), GateAnswer::consistent);
  EXPECT_EQ(gate(judged({size({1.3, 1.6})})), GateAnswer::inconsistent);
  EXPECT_EQ(gate(judged({size({0.5, 0.7})})), GateAnswer::inconsistent);
  EXPECT_EQ(gate(judged({size({0.8, 1.3})})), GateAnswer::undecided);
  EXPECT_THROW(gate({}), StudyError);
}

TEST(Gate, StopsAFilterThatFailsOrWhoseSamplesAreUnusable) {
  Verdict good = judged({size(kRight)});
  good.failed = 2;
  EXPECT_EQ(gate(good), GateAnswer::inconsistent);
  EXPECT_EQ(gate(good, {.failed = 1}), GateAnswer::inconsistent);
  EXPECT_EQ(gate(good, {.failed = 2}), GateAnswer::consistent);
  good.failed = 0;
  good.samples = 600;
  good.unusable = 30;
  EXPECT_EQ(gate(good), GateAnswer::inconsistent);
  EXPECT_EQ(gate(good, {.failed = 600, .unusable = 29}), GateAnswer::inconsistent);
  EXPECT_EQ(gate(good, {.unusable = 30}), GateAnswer::consistent);
  Verdict none;
  none.runs = none.failed = 20;
  EXPECT_EQ(gate(none), GateAnswer::inconsistent);
}

TEST(Margin, IsThatOfTheStudyInTheFileOrRefused) {
  EXPECT_EQ(margin_in(""), kUsualMargin);
  EXPECT_EQ(margin_in("[study]\nname = a\n[record]\nwithin = 3\n"), kUsualMargin);
  EXPECT_EQ(margin_in("[study]\nname = a\nwithin = 1.25\n[scenario]\n"), 1.25);
  for (const char* text : {"1", "0.9", "nan", "1.2x", "", "1e9"}) {
    EXPECT_THROW(margin_in(std::string("[study]\nwithin = ") + text), StudyError) << text;
  }
}

TEST(Looks, AreTheRoundsOfAStudyThatStopsByVerdictOnly) {
  const std::string text = "[study]\nname = a\nuntil = verdict\n[scenario]\n";
  EXPECT_THAT(looks_in(text, 200), ElementsAre(32, 64, 128, 200));
  EXPECT_THAT(looks_in(text, 20), ElementsAre(20));
  EXPECT_THAT(looks_in("[study]\nuntil = verdict, 100 runs\n", 64), ElementsAre(32, 64));
  EXPECT_THAT(looks_in("", 200), IsEmpty());
  EXPECT_THAT(looks_in("[study]\nuntil = position_rmse < 1\n", 200), IsEmpty());
  EXPECT_THAT(looks_in("[study]\nname = a\n[record]\nuntil = verdict\n", 200), IsEmpty());
}

}  // namespace
}  // namespace montecarta::analysis
