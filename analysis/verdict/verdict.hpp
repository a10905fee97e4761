// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/verdict/bets.hpp"
#include "engine/core/judgement.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// The quantity that a family of tests judges (STATISTICS 5).
enum class Family {
  size,                    ///< squared errors of all components at all scans
  component,               ///< squared errors of one component at all scans
  stretch,                 ///< squared errors of all components in one eighth of the scans
  component_by_stretch,    ///< squared errors of one component in one eighth
  scan,                    ///< squared errors of all components at one scan
  bias,                    ///< mean error of one component, in deviations
  bias_by_stretch,         ///< mean error of one component in one eighth, in deviations
  correlation,             ///< correlation of two components beyond the reported one
  correlation_by_stretch,  ///< correlation of two components in one eighth beyond the reported one
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

/// The fewest complete runs for all tests. Studies of fewer are judged by single scans, and by size
/// and components along their drives.
inline constexpr std::size_t kFewestJudgedRuns = 3;

/// The fewest runs that show how much runs differ: a standard deviation of ten values is known to a
/// quarter. Of fewer, size and components are judged along the drives, and the number of further
/// runs is not predicted.
inline constexpr std::size_t kFewestRunsOfAPlan = 10;

/// Returns whether members of a family are ratios of squared errors to the expected ones; else they
/// are numbers that are zero if the filter is consistent.
constexpr bool is_ratio(Family family) { return family <= Family::scan; }

/// Name for readers: "between runs".
std::string name_of(Family family);

/// Name in files: "between_runs".
std::string key_of(Family family);

/// One test of a family.
struct Member {
  std::string name = {};  ///< "heading", "forward and left"; empty if the times name the member
  double from = kNaN, to = kNaN;  ///< [s] first and last time of a stretch or a scan
  double origin = 0.0;            ///< [s] time that readers count from: origin_of() all times
  double estimate = kNaN;  ///< estimated ratio, or number that is zero for a consistent filter
  Interval interval = {kNaN, kNaN};  ///< interval of this member alone
  /// Interval that holds for all members of all families together.
  Interval simultaneous = {kNaN, kNaN};
  /// Interval at the level that shows the member to be off; NaN if it is not.
  Interval shown = {kNaN, kNaN};
  double p = kNaN;  ///< two-sided p-value of this member alone
};

/// The time [s] from which readers count the times of scans: their first one if they are those of a
/// clock, which have ten digits, else 0.
double origin_of(std::span<const double> times);
/// Text of a time [s] counted from `origin`: "12.4 s", or "12.4 s after the start".
std::string time_text(double time, double origin);

/// Name of a member for readers: "heading", "12 s to 24 s", "at 12.4 s".
std::string name_of(const Member& member);

/// A family with its members, and whether it rejects that the filter is consistent.
struct FamilyTest {
  Family family = Family::size;
  std::vector<Member> members = {};
  double p = 1.0;           ///< p-value of the family: Bonferroni over members, Holm over families
  double member_limit = 0;  ///< largest p-value of a member that is shown to be off
  bool is_rejected = false;

  /// The member with the least p-value.
  const Member& strongest() const;
  /// Returns whether `member` is shown to differ from its expectation.
  bool is_shown(const Member& member) const { return is_rejected && member.p <= member_limit; }
};

/// Corrects the p-values of families of tests that are judged together at `level`: Bonferroni over
/// the members of each, Holm (1979) over the families. Fills p, member_limit and is_rejected.
void judge_together(std::vector<FamilyTest>& families, double level);

/// A member of a family with a function that computes its intervals.
struct MemberTest {
  Family family = Family::size;
  Member member;
  std::function<Interval(double level)> interval;
};

/// Groups `tests` into families in the order of kFamilies, with intervals, judged together at
/// `level`.
std::vector<FamilyTest> judge_tests(std::vector<MemberTest> tests, double level);

/// Returns whether the value of a member is shown to be beyond the margin `within`, with all
/// members of all families together.
bool is_beyond_margin(Family family, const Member& member, double within);
/// Returns whether the interval of the member alone lies within the margin.
bool is_within_margin(Family family, const Member& member, double within);

enum class Answer {
  /// Nothing can be judged: no covariance, no complete run, too few draws, or runs that repeat each
  /// other.
  untested,
  consistent,    ///< every deviation is shown to be within the margin
  optimistic,    ///< squared errors are shown to be larger than claimed
  conservative,  ///< squared errors are shown to be smaller than claimed
  /// Squared errors are larger in some parts and smaller in others than claimed; or there is only a
  /// bias, a correlation, a spread between runs, or an error of a component claimed to be exact.
  inconsistent,
  undecided  ///< no deviation and no consistency is shown: more runs are needed
};

/// Name of an answer for readers and files: "consistent", ...
std::string name_of(Answer answer);

/// Findings on errors that are in no test.
struct BesideTests {
  struct Exact {
    std::string component;
    double error;  ///< largest error, in the unit of the component
  };
  /// Components that the filter claims to know exactly although they have errors. No test uses
  /// them.
  std::vector<Exact> exact = {};
  /// Number of runs whose errors repeat those of an earlier run, number by number; the first such
  /// run and that earlier run. Runs must be independent.
  std::uint64_t repeated_runs = 0;
  std::pair<std::uint64_t, std::uint64_t> first_repeat = {};
  /// p-value of the hypothesis that the ratio is the same in all stretches. Times are named only if
  /// it is rejected.
  double p_of_equal_stretches = 1.0;
};

/// Verdict on the covariances of a cell (STATISTICS 5).
struct Verdict {
  Answer answer = Answer::untested;
  Answer of_tests = Answer::untested;  ///< answer by the tests alone, without regard to `beside`
  double level = kUsualLevel;          ///< level of all tests together
  double within = kUsualMargin;        ///< the margin r: ratios in [1/r, r] are consistent
  std::vector<FamilyTest> families = {};
  BesideTests beside = {};
  std::uint64_t runs = 0;      ///< number of runs that ended, complete or failed
  std::uint64_t failed = 0;    ///< number of runs that failed
  std::uint64_t samples = 0;   ///< number of samples of complete runs, without missing ones
  std::uint64_t unusable = 0;  ///< number of samples without a finite error or a covariance matrix
  std::uint64_t missing = 0;   ///< number of scans of complete runs without an estimate
  std::optional<std::uint64_t> more_runs = {};  ///< number of further runs that decide, if known
  /// Whether a deviation is shown to be beyond the margin, at `level` for all tests together: only
  /// then is the filter refused. A deviation within the margin is called slight.
  bool is_refused = false;
  /// The side of the margin on which bets refuse the filter, in a study with interim analyses.
  std::optional<Side> refused_by_bets = {};
  /// Whether covariances are only bounds from above. Then errors that are too small are expected,
  /// nothing is shown to be consistent, and correlations and spreads say nothing.
  bool is_by_upper_bounds = false;
  /// Whether errors are innovations, whose bias is judged beside it (Innovations::components).
  bool is_of_innovations = false;
  /// Interval of the ratio over many drives, of fewer than kFewestRunsOfAPlan runs whose errors are
  /// white: ratio() is that of their own drives. With those of components if it is within the
  /// margin. NaN of others.
  Interval over_drives = {kNaN, kNaN};

  /// Whether something is shown to be off: neither consistent nor undecided nor untested.
  bool has_finding() const;
  /// Whether the filter is off, and by nothing that is shown to be beyond the margin.
  bool is_slight() const;
  /// The tests of a family; nullptr if it does not apply.
  const FamilyTest* find(Family family) const;
  /// Interval of the NEES ratio, by the test that SummedError::size_test() made of Family::size;
  /// NaN if there is none.
  Interval ratio() const;
  double ratio_estimate() const;
};

/// "optimistic", "slightly optimistic", ...
std::string answer_in_words(const Verdict& verdict);

/// Takes the verdict by the margin `within` from families that judge_together() judged at `level`,
/// for `runs` complete runs.
Verdict judge(std::vector<FamilyTest> families, double level, double within, std::uint64_t runs,
              BesideTests beside = {});

/// Takes the covariances of a verdict for upper bounds: what errors that are too small,
/// correlations, spreads and tails had shown is dropped.
void take_for_upper_bounds(Verdict& verdict);

/// Takes `verdict` for that on a few drives whose errors are white. It calls a filter consistent
/// only where `of_any_memory`, the verdict on the same errors whatever their memory is, does too.
void take_for_white_drives(const Verdict& of_any_memory, Verdict& verdict);

/// Refuses a filter by bets (STATISTICS 18), unless it is shown to be consistent.
void refuse_by_bets(Side side, Verdict& verdict);

/// Decision of a script on a filter: accept it, reject it, or wait for more runs.
enum class GateAnswer : std::uint8_t { consistent, inconsistent, undecided };

/// Numbers that a gate tolerates. If there are more, the cell is inconsistent, whatever its errors
/// are.
struct Allowance {
  std::uint64_t failed = 0;    ///< number of failed runs
  std::uint64_t unusable = 0;  ///< number of unusable samples
};

/// Decides by the verdict. Throws StudyError if runs repeat each other, or if nothing
/// was judged and the failures are within `allowed`.
GateAnswer gate(const Verdict& verdict, const Allowance& allowed = {});

}  // namespace montecarta::analysis
