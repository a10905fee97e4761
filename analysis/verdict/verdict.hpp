// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/squares_law.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::analysis {

/// A key of the section [study] in the resolved study of a result file; nullopt if it is not given.
std::optional<std::string> study_setting(const std::string& study_text, std::string_view key);

/// Default margin r: a filter is consistent if the ratio of its NEES to the expected one lies in [1
/// / r, r].
inline constexpr double kUsualMargin = 1.1;
inline constexpr double kLeastMargin = 1.001, kMostMargin = 100.0;

/// study.within of a resolved study, else kUsualMargin. Throws StudyError if it is no number from
/// kLeastMargin to kMostMargin.
double margin_in(const std::string& study_text);

/// Value of study.until if cells stop when their verdict is known.
inline constexpr const char* kUntilVerdict = "verdict";

/// Numbers of runs of the interim analyses in a study of `runs` runs, if its cells stop by verdict;
/// else empty: the verdict is then taken once.
std::vector<std::uint64_t> looks_in(const std::string& study_text, std::uint64_t runs);

/// Subject of a family of tests (STATISTICS 5).
enum class Family {
  size,         ///< squared errors of all components at all scans
  component,    ///< squared errors of one component at all scans
  stretch,      ///< squared errors of all components in one eighth of the scans
  scan,         ///< squared errors of all components at one scan
  bias,         ///< mean error of one component, in deviations
  correlation,  ///< between two components, beyond the reported one
  between_runs  ///< standard deviation of the scales that runs have of their own
};

inline constexpr std::array kFamilies = {
    Family::size, Family::component,   Family::stretch,     Family::scan,
    Family::bias, Family::correlation, Family::between_runs};

/// Returns whether members of a family are ratios of squared errors to the expected ones; else they
/// are numbers that are zero if the filter is consistent.
constexpr bool is_ratio(Family family) {
  return family == Family::size || family == Family::component || family == Family::stretch ||
         family == Family::scan;
}

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
  double p = kNaN;                       ///< two-sided, of this member alone
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

/// A ratio of squared errors to the expected ones, member.estimate, with its law.
MemberTest ratio_test(Family family, Member member, const SquaresLaw& law);

/// Families in the order of kFamilies, with intervals, judged together at `level`.
std::vector<FamilyTest> judge_tests(std::vector<MemberTest> tests, double level);

/// Share of the error probability `alpha` that interim analyses have spent when `information`, in
/// [0, 1], of the runs are there: 2 - 2 Phi(z / sqrt(information)), which resembles the boundaries
/// of O'Brien and Fleming (Lan and DeMets 1983).
double spent(double alpha, double information);

/// Level of the interim analysis of `runs` runs, where `looks` are the increasing numbers of runs
/// of all interim analyses. Each has the error probability that is spent since the one before, so
/// that together they reject with a probability of at most 1 - level, for any dependence between
/// them. Between two looks it is the level of the next one. Without looks it is `level`.
double level_of_look(double level, std::span<const std::uint64_t> looks, std::uint64_t runs);

enum class Answer {
  untested,      ///< no covariance is stored, or no run is complete
  consistent,    ///< every deviation is shown to be within the margin
  optimistic,    ///< squared errors are shown to be larger than claimed
  conservative,  ///< squared errors are shown to be smaller than claimed
  inconsistent,  ///< both, in different parts; or bias, correlation or spread between runs alone
  undecided      ///< neither is shown: more runs are needed
};

/// "consistent", ...
std::string name_of(Answer answer);

/// Verdict on the covariances of a cell (STATISTICS 5).
struct Verdict {
  Answer answer = Answer::untested;
  double level = 0.95;           ///< of all tests together
  double within = kUsualMargin;  ///< the margin r: ratios in [1/r, r] are consistent
  std::vector<FamilyTest> families = {};
  std::uint64_t runs = 0;      ///< that ended, complete or failed
  std::uint64_t failed = 0;    ///< of them
  std::uint64_t samples = 0;   ///< of the complete runs, one a scan
  std::uint64_t unusable = 0;  ///< of them: no finite error or no covariance matrix
  std::optional<std::uint64_t> more_runs = {};  ///< needed for a decision, if known

  /// nullptr where the family does not apply.
  const FamilyTest* find(Family family) const;
  /// Interval of the ratio of all squared errors to the expected ones; NaN where there is none.
  Interval ratio() const;
  double ratio_estimate() const;
};

/// Judges families that were judged together at `level` by the margin `within`, from `runs`
/// complete runs.
Verdict judge(std::vector<FamilyTest> families, double level, double within, std::uint64_t runs);

/// For a table: "consistent within 1.1", "optimistic: NEES 1.28 to 2.25 times too large", ...
/// Failed runs and unusable samples are part of it.
std::string in_words(const Verdict& verdict);

/// One sentence on the cell `label`, with when and in which component.
std::string sentence(const std::string& label, const Verdict& verdict);

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
