// SPDX-License-Identifier: BSD-3-Clause
// Law: a few trajectories of a consistent filter are accused as often as stated, whatever the
// memory of their errors is, and one that is overconfident is found if its errors forget.
#include "analysis/verdict/along_drive.hpp"

#include "tests/analysis/verdict_studies.hpp"
#include "tests/doubles/matchers.hpp"

#include <cstdio>

namespace montecarta::analysis {
namespace {

class SlowOneTrajectory : public testing::TestWithParam<Memory> {};

TEST_P(SlowOneTrajectory, OfAConsistentFilterIsAccusedInFivePercentOfStudiesAtMost) {
  const std::uint64_t studies = studies_of_a_line(40);
  for (const std::size_t runs : {1U, 2U, 5U, 9U}) {
    const double accused = share_of_studies(studies, [&](std::uint64_t study) {
      return is_rejected(verdict_of({.memory = GetParam()}, 100 + study, runs, 200));
    });
    std::printf("%-20s %zu runs of 200 scans: accused %.2f %%\n", name_of(GetParam()), runs,
                100.0 * accused);
    EXPECT_LE(accused, 0.05 + share_errors(0.05, studies));
  }
}

INSTANTIATE_TEST_SUITE_P(OfAnyMemory, SlowOneTrajectory, testing::ValuesIn(kMemories),
                         [](const auto& test) {
                           std::string name = name_of(test.param);
                           std::erase_if(name, [](unsigned char c) { return !std::isalnum(c); });
                           return name;
                         });

TEST(SlowOneTrajectoryPower, ThatIsOverconfidentIsFoundIfItsErrorsForget) {
  const std::uint64_t studies = studies_of_a_line(60);
  const auto found = [&](double ratio) {
    return share_of_studies(studies, [&](std::uint64_t study) {
      const Verdict verdict =
          verdict_of({.memory = Memory::ar95, .ratio = ratio}, 900 + study, 1, 3000);
      return verdict.answer == Answer::optimistic && verdict.ratio().lower > 1.0;
    });
  };
  const double consistent = found(1.0), twice = found(2.0);
  std::printf(
      "one run of 3000 scans, AR(1) 0.95: optimistic %.1f %%, of twice the squares %.1f %%\n",
      100.0 * consistent, 100.0 * twice);
  EXPECT_LE(consistent, 0.05 + share_errors(0.05, studies));
  EXPECT_GE(twice, 0.9);
}

WhitenedRun run_of(std::vector<double> errors) { return {2, errors, errors}; }

TEST(AlongDrive, TestsSizeAndComponentsOfFewRuns) {
  AlongDrive sums;
  sums.add(run_of({1, -2, -1, 2, 1, 2, -1, kNaN, -1, -2}));
  const std::vector<std::string> names = {"a", "b"};
  const std::vector<MemberTest> tests = sums.tests(names);
  ASSERT_EQ(tests.size(), 3U);
  EXPECT_EQ(tests[0].member.estimate, 2.5) << "of the four complete scans";
  EXPECT_EQ(tests[1].member.estimate, 1.0);
  EXPECT_EQ(tests[2].member.name, "b");
  EXPECT_EQ(tests[2].member.estimate, 4.0);
  for (const double level : {0.5, 0.9}) {
    const Interval interval = tests[2].interval(level);
    EXPECT_LT(interval.lower, 4.0);
    EXPECT_GT(interval.upper, 4.0);
    EXPECT_EQ(interval.lower > 1.0, tests[2].member.p < 1.0 - level) << "p is where 1 is the end";
  }
}

TEST(AlongDrive, LeavesOutWhatIsKnownExactlyOrUnknown) {
  const std::vector<std::string> names = {"a", "b"};
  for (const double mark : {kNaN, 1e-162, 0.0}) {
    AlongDrive sums;
    sums.add(run_of({1, mark, -1, mark, 2, -mark, 1, mark}));
    const std::vector<MemberTest> tests = sums.tests(names);
    ASSERT_EQ(tests.size(), 2U) << mark;
    EXPECT_EQ(tests[1].member.name, "a");
    EXPECT_EQ(tests[1].member.estimate, 1.75);
  }
}

TEST(AlongDrive, MergesToTheSameAndForgetsManyRuns) {
  const std::vector<std::string> names = {"a", "b"};
  AlongDrive both, first, second;
  both.add(run_of({1, -2, 3, 4}));
  both.add(run_of({2, 2, -1, 0.5}));
  first.add(run_of({1, -2, 3, 4}));
  second.add(run_of({2, 2, -1, 0.5}));
  first.merge(second);
  EXPECT_EQ(first.tests(names)[0].member.p, both.tests(names)[0].member.p);
  EXPECT_EQ(first.tests(names)[2].member.estimate, both.tests(names)[2].member.estimate);
  for (int run = 2; run < 10; ++run) {
    ASSERT_FALSE(first.tests(names).empty());
    AlongDrive one;
    one.add(run_of({1, 1, 1, 1}));
    first.merge(one);
  }
  EXPECT_EQ(first.runs(), 10U);
  EXPECT_THAT(first.tests(names), testing::IsEmpty());
}

}  // namespace
}  // namespace montecarta::analysis
