// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/study_facts.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/verdict/bets.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// Subject of a family of tests (STATISTICS 5).
enum class Family {
  size,                    ///< squared errors of all components at all scans
  component,               ///< squared errors of one component at all scans
  stretch,                 ///< squared errors of all components in one eighth of the scans
  component_by_stretch,    ///< squared errors of one component in one eighth
  scan,                    ///< squared errors of all components at one scan
  bias,                    ///< mean error of one component, in deviations
  bias_by_stretch,         ///< the same in one eighth
  correlation,             ///< between two components, beyond the reported one
  correlation_by_stretch,  ///< the same in one eighth
  between_runs,            ///< standard deviation of the scales that runs have of their own
  tails                    ///< fourth moment and largest error: a finding, no part of the answer
};

inline constexpr std::array kFamilies = {Family::size,
                                         Family::component,
                                         Family::stretch,
                                         Family::component_by_stretch,
                                         Family::scan,
                                         Family::bias,
                                         Family::bias_by_stretch,
                                         Family::correlation,
                                         Family::correlation_by_stretch,
                                         Family::between_runs,
                                         Family::tails};

/// Studies of fewer complete runs are judged by single scans alone: runs say nothing of how much
/// they vary.
inline constexpr std::size_t kFewestJudgedRuns = 3;

/// Of fewer runs the intervals are too uncertain themselves to say how many more are needed: a
/// standard deviation of ten values is known to a quarter.
inline constexpr std::size_t kFewestRunsOfAPlan = 10;

/// Returns whether members of a family are ratios of squared errors to the expected ones; else they
/// are numbers that are zero if the filter is consistent.
constexpr bool is_ratio(Family family) { return family <= Family::scan; }

/// "between runs", for readers.
std::string name_of(Family family);

/// "between_runs", for files.
std::string key_of(Family family);

/// One test of a family.
struct Member {
  std::string name = {};             ///< "heading", "forward and left"; empty where times name it
  double from = kNaN, to = kNaN;     ///< [s] of a stretch or a scan
  double estimate = kNaN;            ///< ratio, or number that should be zero
  Interval interval = {kNaN, kNaN};  ///< of this member alone
  Interval simultaneous = {kNaN, kNaN};  ///< all members of all families hold with the level
  Interval shown = {kNaN, kNaN};  ///< at the level at which it is shown to be off; NaN if it is not
  double p = kNaN;                ///< two-sided, of this member alone
};

/// "heading", "12 s to 24 s", "at 12.4 s"
std::string name_of(const Member& member);

/// A family with its members, and whether it rejects that the filter is consistent.
struct FamilyTest {
  Family family = Family::size;
  std::vector<Member> members = {};
  double p = 1.0;           ///< of the family: Bonferroni over members, Holm over families
  double member_limit = 0;  ///< largest p of a member that is shown to be off
  bool is_rejected = false;

  /// The member of the least p-value.
  const Member& strongest() const;
  /// Returns whether `member` is shown to differ from its expectation.
  bool is_shown(const Member& member) const { return is_rejected && member.p <= member_limit; }
};

/// Corrects the p-values of families of tests that are judged together at `level`: Bonferroni over
/// the members of each, Holm (1979) over the families. Fills p, member_limit and is_rejected.
void judge_together(std::vector<FamilyTest>& families, double level);

/// A member of a family with a function for its intervals.
struct MemberTest {
  Family family = Family::size;
  Member member;
  std::function<Interval(double level)> interval;
};

/// Families in the order of kFamilies, with intervals, judged together at `level`.
std::vector<FamilyTest> judge_tests(std::vector<MemberTest> tests, double level);

enum class Answer {
  untested,      ///< no covariance is stored, or no run is complete
  consistent,    ///< every deviation is shown to be within the margin
  optimistic,    ///< squared errors are shown to be larger than claimed
  conservative,  ///< squared errors are shown to be smaller than claimed
  inconsistent,  ///< both, in different parts; or bias, correlation, spread between runs, or an
                 ///< error of a component that is claimed to be exact, alone
  undecided      ///< neither is shown: more runs are needed
};

/// "consistent", ...
std::string name_of(Answer answer);

/// What is said of errors beside the tests.
struct BesideTests {
  struct Exact {
    std::string component;
    double error;  ///< the largest one, in the unit of the component
  };
  /// Components that the filter claims to know exactly and that have errors. They are in no test.
  std::vector<Exact> exact = {};
  /// Runs whose errors are those of an earlier run, number by number; the first of them and that
  /// earlier one. Runs must be independent.
  std::uint64_t repeated_runs = 0;
  std::pair<std::uint64_t, std::uint64_t> first_repeat = {};
  /// Of the ratio being the same in all stretches. Times are named only if it is not.
  double p_of_equal_stretches = 1.0;
};

/// Verdict on the covariances of a cell (STATISTICS 5).
struct Verdict {
  Answer answer = Answer::untested;
  Answer of_tests = Answer::untested;  ///< by the tests alone, without regard to `beside`
  double level = kUsualLevel;          ///< of all tests together
  double within = kUsualMargin;        ///< the margin r: ratios in [1/r, r] are consistent
  std::vector<FamilyTest> families = {};
  BesideTests beside = {};
  std::uint64_t runs = 0;      ///< that ended, complete or failed
  std::uint64_t failed = 0;    ///< of them
  std::uint64_t samples = 0;   ///< of the complete runs, one a scan
  std::uint64_t unusable = 0;  ///< of them: no finite error or no covariance matrix
  std::optional<std::uint64_t> more_runs = {};  ///< needed for a decision, if known
  /// Whether a deviation is shown to be beyond the margin, at `level` for all tests together: only
  /// then is the filter refused. A deviation within the margin is called slight.
  bool is_refused = false;
  /// The side of the margin on which bets refuse the filter, in a study with interim analyses.
  std::optional<Side> refused_by_bets = {};

  /// nullptr where the family does not apply.
  const FamilyTest* find(Family family) const;
  /// Interval of the ratio of all squared errors to the expected ones; NaN where there is none.
  Interval ratio() const;
  double ratio_estimate() const;
};

/// Judges families that were judged together at `level` by the margin `within`, from `runs`
/// complete runs.
Verdict judge(std::vector<FamilyTest> families, double level, double within, std::uint64_t runs,
              BesideTests beside = {});

/// Refuses a filter by bets (STATISTICS 18), unless it is shown to be consistent.
void refuse_by_bets(Side side, Verdict& verdict);

/// Decision of a script on a filter: accept it, reject it, or wait for more runs.
enum class GateAnswer : std::uint8_t { consistent, inconsistent, undecided };

/// Numbers that a gate tolerates. More than these are inconsistent for any errors.
struct Allowance {
  std::uint64_t failed = 0;    ///< runs
  std::uint64_t unusable = 0;  ///< samples
};

/// Throws StudyError if nothing was judged and nothing failed.
GateAnswer gate(const Verdict& verdict, const Allowance& allowed = {});

}  // namespace montecarta::analysis
