// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/verdict.hpp"

#include "analysis/run/study_facts.hpp"
#include "analysis/verdict/sentence.hpp"
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

// The mean of all is off, but within the margin; heading and one scan are not.
TEST(Sentence, LeadsWithWhatIsBeyondTheMargin) {
  const FamilyTest whole = size({1.02, 1.06});
  const FamilyTest components =
      family(Family::component, {{"heading", {1.3, 1.6}}, {"forward", kRight}});
  FamilyTest parts = stretches({{1.02, 1.05}, kRight});
  parts.members[0].p = 1e-9;
  EXPECT_THAT(sentence("x", judged({whole, components, parts})),
              HasSubstr(": its squared errors in heading are 1.30 to 1.60 times what it claims"));
  FamilyTest scan = family(Family::scan, {{"", {1.5, 2.0}}});
  scan.members[0].from = scan.members[0].to = 3.0;
  EXPECT_THAT(sentence("x", judged({whole, scan})),
              HasSubstr(": its squared errors at 3.0 s are 1.50 to 2.00 times what it claims"));
  EXPECT_THAT(sentence("x", judged({whole, parts})), HasSubstr("1.02 to 1.06"));
}

// Half the interval in logarithms is log 1.1. The estimate is right, and off by 0.6745 of 1.96
// standard errors in half of all studies.
TEST(Judge, SaysHowManyRunsDecide) {
  const Verdict found = judged({size({1.0 / 1.1, 1.1})}, 1.05);
  ASSERT_TRUE(found.more_runs);
  const double growth = std::pow((1.0 + 0.67449 / 1.95996) * std::log(1.1) / std::log(1.05), 2);
  EXPECT_NEAR(static_cast<double>(*found.more_runs), 200.0 * (growth - 1.0), 1.0);
  EXPECT_FALSE(judged({size({0.9, HUGE_VAL})}).more_runs);
  EXPECT_FALSE(judged({size(kRight)}).more_runs) << "it is decided";
  std::vector<FamilyTest> few = {size({0.5, 2.0})};
  judge_together(few, 0.95);
  EXPECT_FALSE(judge(few, 0.95, 1.1, 9).more_runs) << "of less than 10 it is not known";
}

TEST(Judge, RefusesOnlyWhatIsShownToBeBeyondTheMargin) {
  const Verdict slight = judged({size({1.02, 1.3})}, 1.2);
  EXPECT_EQ(slight.answer, Answer::optimistic);
  EXPECT_FALSE(slight.is_refused);
  EXPECT_EQ(gate(slight), GateAnswer::undecided);
  EXPECT_TRUE(slight.more_runs);
  EXPECT_THAT(sentence("a", slight), HasSubstr("a is slightly optimistic"));
  const Verdict gross = judged({size({1.21, 1.5})}, 1.2);
  EXPECT_TRUE(gross.is_refused);
  EXPECT_EQ(gate(gross), GateAnswer::inconsistent);
  const auto with_bias = [](const Interval& bias) {
    return judged({size(kRight), family(Family::bias_by_stretch, {{"left", bias}})}, 1.25);
  };
  EXPECT_FALSE(with_bias({0.45, 0.7}).is_refused) << "sqrt(0.25) is 0.5";
  EXPECT_TRUE(with_bias({0.55, 0.7}).is_refused);
}

TEST(Judge, TakesHeavyTailsForNoFaultOfTheCovariance) {
  const Verdict found =
      judged({size(kRight), family(Family::tails, {{"fourth moment", {1.0, 3.0}}})});
  EXPECT_EQ(found.answer, Answer::consistent);
  EXPECT_THAT(sentence("a", found), HasSubstr("heavier tails than a Gaussian"));
  EXPECT_EQ(
      judged({size({0.8, 1.3}), family(Family::tails, {{"fourth moment", {1.0, 3.0}}})}).answer,
      Answer::undecided);
}

TEST(Members, CountTheTimesOfAClockFromTheStart) {
  const std::vector<double> drive = {0.5, 60.0}, clock = {1403636579.75, 1403636598.5};
  EXPECT_EQ(origin_of(drive), 0.0);
  EXPECT_EQ(name_of(Member{.from = 0.5, .to = 60.0, .origin = origin_of(drive)}),
            "0.500 s to 60.0 s");
  const double origin = origin_of(clock);
  EXPECT_EQ(name_of(Member{.name = "rz", .from = clock[0], .to = clock[1], .origin = origin}),
            "rz from 0.00 s to 18.8 s after the start");
  EXPECT_EQ(name_of(Member{.from = clock[1], .to = clock[1], .origin = origin}),
            "at 18.8 s after the start");
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

/// A verdict on a ratio that differs from stretch to stretch.
Verdict judged_over_time(std::vector<FamilyTest> families) {
  judge_together(families, 0.95);
  return judge(std::move(families), 0.95, 1.1, 200, {.p_of_equal_stretches = 0.001});
}

TEST(Words, SayHowMuchWhenAndWhere) {
  const Interval off = {1.4, 2.4};
  const FamilyTest components = family(
      Family::component, {{"forward", {3.0, 4.0}}, {"left", {1.1, 1.6}}, {"heading", {1.0, 1.7}}});
  const std::vector<FamilyTest> families = {size({1.28, 2.25}), components,
                                            stretches({kRight, kRight, off, off})};
  const Verdict late = judged_over_time(families);
  EXPECT_EQ(in_words(late), "optimistic: NEES 1.28 to 2.25 times too large, from 20.0 s on");
  EXPECT_EQ(sentence("ekf_slam", late),
            "ekf_slam is optimistic (overconfident): on average its squared errors are 1.70 times "
            "what it claims (95 %: 1.28 to 2.25), shown from 20.0 s on, mainly forward (3.00 to "
            "4.00 times).");
  EXPECT_EQ(in_words(judged(families)), "optimistic: NEES 1.28 to 2.25 times too large")
      << "stretches do not differ";
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
  EXPECT_EQ(words(family(Family::bias, {{"forward", {-0.5, -0.4}}})),
            "inconsistent: a bias forward of -0.50 to -0.40 standard deviations");
  EXPECT_EQ(words(family(Family::correlation, {{"a and b", {-0.6, -0.4}}})),
            "inconsistent: an unreported correlation of -0.60 to -0.40 between a and b");
  EXPECT_THAT(words(family(Family::between_runs, {{"runs", {0.3, 0.6}}})),
              HasSubstr("differ by a standard deviation of 0.30 to 0.60)"));
}

TEST(Words, ListEveryFamilyThatIsShown) {
  const FamilyTest bias = family(Family::bias, {{"heading", {0.4, 0.6}}});
  const FamilyTest correlation = family(Family::correlation, {{"a and b", {0.4, 0.6}}});
  const Verdict found = judged({size({1.3, 1.6}), bias, correlation});
  const std::string text = sentence("a", found);
  const auto of_bias = text.find("; a bias in heading of 0.40 to 0.60 standard deviations");
  const auto of_correlation = text.find("; an unreported correlation of 0.40 to 0.60");
  EXPECT_NE(of_bias, std::string::npos) << text;
  EXPECT_NE(of_correlation, std::string::npos) << text;
  EXPECT_THAT(in_words(found), HasSubstr("; also bias, correlation"));
  const FamilyTest spread = family(Family::between_runs, {{"runs", {0.3, 0.6}}});
  const FamilyTest components = family(Family::component, {{"a", {1.2, 1.5}}, {"b", {0.6, 0.8}}});
  EXPECT_THAT(sentence("x", judged({size({0.9, 1.2}), components, spread})),
              HasSubstr("x is inconsistent: runs have scales of their own"));
}

TEST(Words, NameBiasesThatCancelWithTheirTimes) {
  FamilyTest test = family(Family::bias_by_stretch, {{"a", {0.5, 0.9}}, {"a", {-0.9, -0.5}}});
  for (std::size_t k = 0; k < 2; ++k) {
    test.members[k].from = 10.0 * static_cast<double>(k);
    test.members[k].to = 10.0 * static_cast<double>(k + 1);
  }
  const std::string text = sentence("x", judged({size(kRight), test}));
  EXPECT_THAT(text, HasSubstr("a bias in a from 0.00 s to 10.0 s of 0.50 to 0.90"));
  EXPECT_THAT(text, HasSubstr("a bias in a from 10.0 s to 20.0 s of -0.90 to -0.50"));
}

TEST(Words, NameNoFamilyThatWasNotJudged) {
  const FamilyTest bias = family(Family::bias, {{"a", {-0.1, 0.1}}, {"b", {-0.1, 0.1}}});
  EXPECT_THAT(sentence("x", judged({size(kRight)})), HasSubstr("on average; its components were"));
  EXPECT_THAT(sentence("x", judged({size(kRight), bias})),
              HasSubstr("in every component; correlations were not judged"));
}

TEST(Words, SaySlightDeviationsAndWhatIsNotExcluded) {
  const Verdict found = judged({size({1.02, 1.06})});
  EXPECT_EQ(in_words(found), "consistent within 1.1, slightly optimistic (1.02 to 1.06)");
  const FamilyTest bias = family(Family::bias, {{"a", {-0.1, 0.1}}, {"b", {-0.1, 0.1}}});
  const FamilyTest correlation = family(Family::correlation, {{"a and b", {-0.05, 0.05}}});
  EXPECT_EQ(
      sentence("smoother", judged({size(kRight), stretches({kRight, kRight}), bias, correlation})),
      "smoother is consistent within 1.1 in every component and in every eighth of the drive; "
      "events rarer than 1 in 66 runs are not excluded.");
  Verdict open = judged({size({0.8, 1.3})});
  open.more_runs = 130;
  EXPECT_EQ(in_words(open), "undecided: about 130 more runs decide");
  open.more_runs.reset();
  EXPECT_EQ(in_words(open), "undecided: many more runs decide");
  open.runs = 1;
  EXPECT_EQ(in_words(open), "undecided: take at least 10 runs");
  EXPECT_THAT(
      sentence("a", open),
      HasSubstr(
          "no fault is shown, and 1 run is too few to show that it is consistent within 1.1"));
  EXPECT_EQ(in_words(Verdict{}), "not tested");
}

TEST(Words, SayWhatFailedAndKnowErrorsOfZero) {
  FamilyTest scan = family(Family::scan, {{"", {1.05, 1.5}}});
  scan.members[0].from = scan.members[0].to = 1.0;
  EXPECT_EQ(in_words(judged({size(kRight), scan})),
            "consistent within 1.1, slightly optimistic at 1.0 s (1.05 to 1.50)");
  EXPECT_THAT(sentence("a", judged({size({0.0, 0.0})})), HasSubstr("errors are all exactly 0"));
  EXPECT_THAT(in_words(judged({size({1e40, 1e50})})), HasSubstr("more than 1.00e20 times"));
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

TEST(StudyFacts, HaveTheMarginOfTheStudyInTheFileOrRefuseIt) {
  const auto margin_in = [](const std::string& text) { return study_facts_in(text, 1).within; };
  EXPECT_EQ(margin_in(""), kUsualMargin);
  EXPECT_EQ(margin_in("[study]\nname = a\n[record]\nwithin = 3\n"), kUsualMargin);
  EXPECT_EQ(margin_in("[study]\nname = a\nwithin = 1.25\n[scenario]\n"), 1.25);
  for (const char* text : {"1", "0.9", "nan", "1.2x", "", "1e9"}) {
    EXPECT_THROW(margin_in(std::string("[study]\nwithin = ") + text), StudyError) << text;
  }
}

TEST(StudyFacts, HaveInterimAnalysesOfAStudyThatStopsByVerdictOnly) {
  const auto analyses = [](const std::string& text, std::uint64_t runs) {
    return study_facts_in(text, runs).runs_at_analyses;
  };
  const std::string text = "[study]\nname = a\nuntil = verdict\n[scenario]\n";
  EXPECT_THAT(analyses(text, 200), ElementsAre(32, 64, 128, 200));
  EXPECT_THAT(analyses(text, 20), ElementsAre(20));
  EXPECT_THAT(analyses("[study]\nuntil = verdict, 100 runs\n", 64), ElementsAre(32, 64));
  EXPECT_THAT(analyses("", 200), IsEmpty());
  const std::string by_score = "[study]\nuntil = position_rmse < 1\n";
  EXPECT_THAT(analyses(by_score, 200), IsEmpty());
  EXPECT_TRUE(study_facts_in(by_score, 200).stops_early);
  EXPECT_THAT(analyses("[study]\nname = a\n[record]\nuntil = verdict\n", 200), IsEmpty());
}

}  // namespace
}  // namespace montecarta::analysis
