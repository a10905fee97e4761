// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/whole_error.hpp"

#include "analysis/run/nees.hpp"
#include "analysis/run/whitened_run.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/verdict/sentence.hpp"
#include "engine/errors.hpp"
#include "tests/analysis/verdict_studies.hpp"
#include "tests/doubles/matchers.hpp"

namespace montecarta::analysis {
namespace {

constexpr std::size_t kScansOfARun = 64;

std::vector<Family> families_of(const Verdict& verdict) {
  std::vector<Family> all;
  for (const FamilyTest& test : verdict.families) all.push_back(test.family);
  return all;
}

TEST(WholeError, HasElevenFamiliesWithTheirMembers) {
  const Verdict found = verdict_of(PlantedLaw{}, 1, 60, kScansOfARun);
  EXPECT_THAT(families_of(found), ElementsAreArray(kFamilies));
  std::vector<std::size_t> members;
  for (const FamilyTest& test : found.families) members.push_back(test.members.size());
  EXPECT_THAT(members, ElementsAre(1, 3, 8, 24, 64, 3, 24, 3, 24, 1, 2));
  EXPECT_EQ(found.find(Family::correlation)->members[1].name, "a and c");
  EXPECT_EQ(found.find(Family::stretch)->members[7].from, 57.0);
  EXPECT_EQ(found.find(Family::stretch)->members[7].to, 64.0);
  EXPECT_EQ(name_of(found.find(Family::component_by_stretch)->members[8]),
            "b from 1.00 s to 8.00 s");
}

TEST(WholeError, LeavesOutFamiliesThatDoNotApply) {
  EXPECT_THAT(families_of(verdict_of({.dimension = 1}, 1, 20, 15)),
              ElementsAre(Family::size, Family::scan, Family::bias, Family::tails));
  EXPECT_THAT(families_of(verdict_of(PlantedLaw{}, 1, 2, kScansOfARun)),
              ElementsAre(Family::size, Family::component, Family::scan));
  const Verdict many = verdict_of({.dimension = 15}, 1, 60, kScansOfARun);
  EXPECT_EQ(many.find(Family::correlation)->members.size(), 2) << "two directions";
}

/// 60 runs of two scans and one component with these errors in even runs, and minus them in odd
/// ones.
WholeError two_scans(double first, double second) {
  WholeError sums(1, 2);
  for (int run = 0; run < 60; ++run) {
    const double sign = run % 2 == 0 ? 1.0 : -1.0;
    const WhitenedRun errors{1, {sign * first, sign * second}, {sign * first, sign * second}};
    sums.add(errors, nees_of(errors));
  }
  return sums;
}

TEST(WholeError, EstimatesByHand) {
  const Verdict found = verdict_of(two_scans(1.0, 2.0), 1, 2, 60);
  EXPECT_DOUBLE_EQ(found.ratio_estimate(), 2.5);
  const FamilyTest& scans = *found.find(Family::scan);
  EXPECT_DOUBLE_EQ(scans.members[0].estimate, 1.0);
  EXPECT_DOUBLE_EQ(scans.members[1].estimate, 4.0);
  const Interval exact = nees_bounds(60, 1, 0.95);
  EXPECT_NEAR(scans.members[1].interval.lower, 4.0 / exact.upper, 1e-9);
  EXPECT_NEAR(scans.members[1].interval.upper, 4.0 / exact.lower, 1e-9);
  EXPECT_NEAR(found.find(Family::bias)->members[0].estimate, 0.0, 1e-15);
}

// One run has no error at the first scan, another none at all: they are left out where they have no
// number.
TEST(WholeError, LeavesOutWhatIsMissing) {
  WholeError sums = two_scans(1.0, 1.0);
  const WhitenedRun half{1, {kNaN, 3.0}, {kNaN, 3.0}}, none{1, {kNaN, kNaN}, {kNaN, kNaN}};
  sums.add(half, std::vector<double>{kNaN, 9.0});
  sums.add(none, std::vector<double>{kNaN, 5.0});  // a singular covariance: its NEES counts
  const Verdict found = verdict_of(sums, 1, 2, 62);
  EXPECT_DOUBLE_EQ(found.ratio_estimate(), 74.0 / 62.0);
  EXPECT_DOUBLE_EQ(found.find(Family::scan)->members[0].estimate, 1.0);
  EXPECT_DOUBLE_EQ(found.find(Family::scan)->members[1].estimate, 74.0 / 62.0);
}

// Groups of eight runs end where blocks do, so that none is lost.
TEST(WholeError, OfTwoBlocksIsThatOfAllRuns) {
  WholeError all(3, kScansOfARun), first = all, second = all;
  for (std::uint64_t run = 0; run < 400; ++run) {
    const WhitenedRun errors = drawn_run({.memory = Memory::ar95}, 3, run, kScansOfARun);
    all.add(errors, nees_of(errors));
    (run < 200 ? first : second).add(errors, nees_of(errors));
  }
  merge_into(first, second);
  const Verdict merged = verdict_of(first, 3, kScansOfARun, 400);
  const Verdict wanted = verdict_of(all, 3, kScansOfARun, 400);
  for (const Family family : {Family::size, Family::stretch, Family::between_runs}) {
    const Member &found = merged.find(family)->members[0], &one = wanted.find(family)->members[0];
    EXPECT_NEAR(found.p, one.p, 1e-9) << name_of(family);
    EXPECT_NEAR(found.interval.lower, one.interval.lower, 1e-9) << name_of(family);
  }
}

/// Errors of a law with samples that are missing at random, as for a singular covariance.
WholeError with_missing(const PlantedLaw& law, std::uint64_t study, std::uint64_t runs,
                        double missing) {
  WholeError sums(law.dimension, kScansOfARun);
  for (std::uint64_t run = 0; run < runs; ++run) {
    WhitenedRun errors = drawn_run(law, study, run, kScansOfARun);
    const std::vector<double> nees = nees_of(errors);
    RngStream draw({.seed = study, .run = run, .index = 1, .purpose = Draw::test});
    for (std::size_t s = 0; s < kScansOfARun; ++s) {
      if (draw.uniform() >= missing) continue;
      for (std::size_t k = 0; k < law.dimension; ++k) {
        errors.whitened[s * law.dimension + k] = errors.standardised[s * law.dimension + k] = kNaN;
      }
    }
    sums.add(errors, nees);
  }
  return sums;
}

TEST(WholeError, SlowRejectsAConsistentFilterSeldomWhereSamplesAreMissing) {
  for (const Memory memory : {Memory::white, Memory::constant}) {
    const double rejected = share_of_studies(200, [&](std::uint64_t study) {
      const WholeError sums = with_missing({.memory = memory}, study, 60, 0.3);
      return is_rejected(verdict_of(sums, 3, kScansOfARun, 60));
    });
    EXPECT_LT(rejected, 0.05 + share_errors(0.05, 200)) << name_of(memory);
  }
}

// Five of six components are known exactly, so that errors have one sixth of the terms.
TEST(WholeError, RejectsAConsistentFilterSeldomWhereComponentsAreExact) {
  int rejected = 0;
  for (std::uint64_t study = 0; study < 200; ++study) {
    WholeError sums(6, 4);
    for (std::uint64_t run = 0; run < 30; ++run) {
      RngStream draw({.seed = study, .run = run, .purpose = Draw::test});
      const double error = draw.normal();
      WhitenedRun errors{6, std::vector<double>(24, kNaN), {}};
      for (std::size_t s = 0; s < 4; ++s) errors.whitened[6 * s] = error;
      errors.standardised = errors.whitened;
      sums.add(errors, std::vector<double>(4, on_full_scale({error * error, 1}, 6)));
    }
    rejected += is_rejected(verdict_of(sums, 6, 4, 30)) ? 1 : 0;
  }
  EXPECT_LT(rejected, 200 * (0.05 + share_errors(0.05, 200)));
}

TEST(WholeError, JudgesCovariancesThatAreAlwaysSingularByTheirNees) {
  WholeError sums(3, 20);
  const WhitenedRun none{3, std::vector<double>(60, kNaN), std::vector<double>(60, kNaN)};
  for (int run = 0; run < 50; ++run) sums.add(none, std::vector<double>(20, 300.0));
  const Verdict found = verdict_of(sums, 3, 20, 50);
  EXPECT_THAT(families_of(found), ElementsAre(Family::size, Family::stretch, Family::scan));
  EXPECT_EQ(found.answer, Answer::optimistic);
  EXPECT_THAT(sentence("a", found), Not(HasSubstr("component")));
}

// One of 16 scans has a covariance of full rank: it does not speak for the others.
TEST(WholeError, IsNotConsistentByAFewWholeSamples) {
  WholeError sums(3, 16);
  for (std::uint64_t run = 0; run < 300; ++run) {
    WhitenedRun errors = drawn_run(PlantedLaw{}, 2, run, 16);
    std::vector<double> nees = nees_of(errors);
    for (std::size_t i = 3; i < 48; ++i) errors.whitened[i] = errors.standardised[i] = kNaN;
    for (std::size_t s = 1; s < 16; ++s) nees[s] *= 1.5;
    sums.add(errors, nees);
  }
  EXPECT_EQ(verdict_of(sums, 3, 16, 300, 1.4).answer, Answer::optimistic);
}

TEST(WholeError, RejectsABiasThatNeverVaries) {
  WholeError sums(1, 4);
  const WhitenedRun errors{1, {0.5, 0.5, 0.5, 0.5}, {0.5, 0.5, 0.5, 0.5}};
  for (int run = 0; run < 30; ++run) sums.add(errors, nees_of(errors));
  EXPECT_EQ(verdict_of(sums, 1, 4, 30).find(Family::bias)->p, 0.0);
}

// Law: the names of runs mean nothing, so their order changes nothing but rounding, and which eight
// runs are compared with each other.
TEST(WholeError, DoesNotDependOnTheOrderOfTheRuns) {
  WholeError forwards(2, 20), backwards(2, 20);
  for (std::uint64_t run = 0; run < 60; ++run) {
    const WhitenedRun one = drawn_run({.dimension = 2}, 3, run, 20);
    const WhitenedRun other = drawn_run({.dimension = 2}, 3, 59 - run, 20);
    forwards.add(one, nees_of(one));
    backwards.add(other, nees_of(other));
  }
  const Verdict a = verdict_of(forwards, 2, 20, 60), b = verdict_of(backwards, 2, 20, 60);
  for (std::size_t f = 0; f < a.families.size(); ++f) {
    if (a.families[f].family >= Family::between_runs) continue;
    for (std::size_t m = 0; m < a.families[f].members.size(); ++m) {
      EXPECT_NEAR(a.families[f].members[m].p, b.families[f].members[m].p, 1e-9);
    }
  }
}

// Law: a filter that is off by one factor at all scans has the p-value and interval of the right
// one, scaled: the deviation over runs has the scale of the ratio.
TEST(WholeError, ScalesItsIntervalWithTheRatio) {
  const Verdict right = verdict_of({.memory = Memory::ar95}, 5, 60, kScansOfARun);
  const Verdict off = verdict_of({.memory = Memory::ar95, .ratio = 4.0}, 5, 60, kScansOfARun);
  EXPECT_NEAR(off.ratio().lower, 4.0 * right.ratio().lower, 1e-9);
  EXPECT_NEAR(off.ratio().upper, 4.0 * right.ratio().upper, 1e-9);
  EXPECT_NEAR(off.find(Family::between_runs)->p, right.find(Family::between_runs)->p, 1e-9);
}

// A planar truth in a filter in space: heights have no error at all, but a variance.
TEST(WholeError, NamesAComponentWhoseErrorsAreExactlyZero) {
  WholeError sums(3, kScansOfARun);
  for (std::uint64_t run = 0; run < 100; ++run) {
    WhitenedRun errors = drawn_run({.memory = Memory::ar95}, 4, run, kScansOfARun);
    for (std::size_t i = 2; i < errors.whitened.size(); i += 3) errors.whitened[i] = 0.0;
    errors.standardised = errors.whitened;
    sums.add(errors, nees_of(errors));
  }
  const Verdict found = verdict_of(sums, 3, kScansOfARun, 100, 1.8);
  EXPECT_EQ(found.find(Family::component)->members[2].estimate, 0.0);
  EXPECT_TRUE(found.is_refused);
  EXPECT_THAT(sentence("a", found), HasSubstr("its errors in c are all exactly 0"));
}

TEST(WholeError, ReportsErrorsOfComponentsThatAreClaimedToBeExact) {
  WholeError sums(2, kScansOfARun);
  for (std::uint64_t run = 0; run < 300; ++run) {
    WhitenedRun errors = drawn_run({.dimension = 2}, 4, run, kScansOfARun);
    for (std::size_t i = 1; i < errors.whitened.size(); i += 2) {
      errors.whitened[i] = errors.standardised[i] = kNaN;
    }
    errors.errors_of_exact = {0.0, run == 7 ? 3e-8 : 1e-8};
    std::vector<double> nees;
    for (std::size_t i = 0; i < errors.whitened.size(); i += 2) {
      nees.push_back(on_full_scale({std::pow(errors.whitened[i], 2), 1}, 2));
    }
    sums.add(errors, nees);
  }
  const Verdict found = verdict_of(sums, 2, kScansOfARun, 300, 1.3);
  EXPECT_EQ(found.answer, Answer::inconsistent);
  EXPECT_EQ(found.of_tests, Answer::consistent);
  EXPECT_TRUE(found.is_refused);
  ASSERT_EQ(found.beside.exact.size(), 1);
  EXPECT_EQ(found.beside.exact[0].component, "b");
  EXPECT_EQ(found.beside.exact[0].error, 3e-8);
  EXPECT_NEAR(found.ratio_estimate(), 1.0, 0.1) << "the errors of b are not in it";
}

TEST(WholeError, RefusesRunsThatAreOthersAgain) {
  WholeError first(3, 16), second = first;
  for (std::uint64_t run = 0; run < 40; ++run) {
    WhitenedRun errors = drawn_run({}, 5, run % 20, 16);
    errors.number = run;
    (run < 24 ? first : second).add(errors, nees_of(errors));
  }
  merge_into(first, second);
  const Verdict found = verdict_of(first, 3, 16, 40, 2.0);
  EXPECT_EQ(found.answer, Answer::untested);
  EXPECT_EQ(found.beside.repeated_runs, 20);
  EXPECT_EQ(found.beside.first_repeat, std::pair(std::uint64_t{20}, std::uint64_t{0}));
  EXPECT_THROW(gate(found), StudyError);
}

// The law of a scan is exact for one run too.
TEST(WholeError, RejectsOneRunByASingleScan) {
  WhitenedRun errors = drawn_run({}, 6, 0, kScansOfARun);
  errors.whitened[90] = 700.0;
  errors.standardised = errors.whitened;
  WholeError sums(3, kScansOfARun);
  sums.add(errors, nees_of(errors));
  const Verdict found = verdict_of(sums, 3, kScansOfARun, 1);
  EXPECT_EQ(found.answer, Answer::optimistic);
  EXPECT_TRUE(found.is_refused);
  EXPECT_EQ(name_of(found.find(Family::scan)->strongest()), "at 31.0 s");
}

/// The answer on runs whose errors are exactly 0 at the first `zeros` scans.
Answer answer_with_zeros(std::uint64_t runs, std::size_t zeros) {
  WholeError sums(3, kScansOfARun);
  for (std::uint64_t run = 0; run < runs; ++run) {
    WhitenedRun errors = drawn_run({}, 8, run, kScansOfARun);
    std::fill_n(errors.whitened.begin(), 3 * zeros, 0.0);
    errors.standardised = errors.whitened;
    sums.add(errors, nees_of(errors));
  }
  return verdict_of(sums, 3, kScansOfARun, runs).answer;
}

// Errors of files with few digits are exactly 0 here and there, by chance also in a few runs at
// once.
TEST(WholeError, TakesErrorsOfExactlyZeroForRoundedOnesInFewRuns) {
  EXPECT_EQ(answer_with_zeros(1, 1), Answer::undecided);
  EXPECT_EQ(answer_with_zeros(9, 1), Answer::undecided);
  EXPECT_EQ(answer_with_zeros(10, 1), Answer::conservative);
  EXPECT_EQ(answer_with_zeros(1, kScansOfARun), Answer::conservative) << "a copy of the truth";
}

// One error of 30 deviations in 50 runs makes no filter optimistic, but it is named.
TEST(WholeError, NamesTheLargestErrorWithRunAndTime) {
  WholeError sums(3, kScansOfARun);
  for (std::uint64_t run = 0; run < 50; ++run) {
    WhitenedRun errors = drawn_run({}, 7, run, kScansOfARun);
    if (run == 17) errors.whitened[91] = 30.0;
    errors.standardised = errors.whitened;
    sums.add(errors, nees_of(errors));
  }
  const Verdict found = verdict_of(sums, 3, kScansOfARun, 50);
  EXPECT_FALSE(is_rejected(found));
  const Member& largest = found.find(Family::tails)->members.back();
  EXPECT_EQ(largest.estimate, 30.0);
  EXPECT_EQ(name_of(largest), "b in run 17 at 31.0 s");
  EXPECT_THAT(sentence("a", found), HasSubstr("b in run 17 at 31.0 s"));
}

// The heading of a filter can be right on average while P is singular in another direction.
TEST(WholeError, JudgesComponentsOfASingularCovariance) {
  WholeError sums(3, kScansOfARun);
  for (std::uint64_t run = 0; run < 200; ++run) {
    WhitenedRun errors = drawn_run({.by_component = {1.5, 1.5, 0.5}}, 8, run, kScansOfARun);
    std::vector<double> nees;
    for (std::size_t i = 0; i < errors.whitened.size(); i += 3) {
      const double squares = std::pow(errors.whitened[i], 2) + std::pow(errors.whitened[i + 2], 2);
      nees.push_back(on_full_scale({squares, 2}, 3));
      errors.standardised[i + 1] = errors.standardised[i];
    }
    std::ranges::fill(errors.whitened, kNaN);
    sums.add(errors, nees);
  }
  const Verdict found = verdict_of(sums, 3, kScansOfARun, 200, 1.2);
  EXPECT_EQ(found.answer, Answer::inconsistent);
  EXPECT_TRUE(is_rejected(found, Family::component));
  EXPECT_EQ(found.find(Family::correlation), nullptr);
}

}  // namespace
}  // namespace montecarta::analysis
