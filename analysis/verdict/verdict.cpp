// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/verdict.hpp"

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/paired_tests.hpp"
#include "engine/errors.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace montecarta::analysis {

namespace {

std::string after_start(double origin) { return origin == 0.0 ? "" : " after the start"; }

}  // namespace

std::string name_of(Family family) {
  constexpr std::array kNames = {
      "size", "component",       "stretch",     "component by stretch",   "scan",
      "bias", "bias by stretch", "correlation", "correlation by stretch", "between runs",
      "tails"};
  return kNames.at(static_cast<std::size_t>(family));
}

std::string key_of(Family family) {
  std::string key = name_of(family);
  std::ranges::replace(key, ' ', '_');
  return key;
}

double origin_of(std::span<const double> times) {
  constexpr double kLeastClock = 1e6;  // [s] 12 days
  return times.empty() || std::abs(times.front()) < kLeastClock ? 0.0 : times.front();
}

std::string time_text(double time, double origin) {
  return clock_text(time - origin) + after_start(origin);
}

std::string name_of(const Member& member) {
  if (std::isnan(member.from)) return member.name;
  const bool is_scan = member.from == member.to;
  const double from = member.from - member.origin;
  std::string time = is_scan ? "at " + fixed_seconds(from) + after_start(member.origin)
                             : clock_text(from) + " to " + time_text(member.to, member.origin);
  if (member.name.empty()) return time;
  return member.name + (is_scan ? " " : " from ") + time;
}

const Member& FamilyTest::strongest() const {
  return *std::ranges::min_element(members, {}, &Member::p);
}

void judge_together(std::vector<FamilyTest>& families, double level) {
  std::vector<double> p_values;
  for (const FamilyTest& test : families) {
    double least = 1.0;
    for (const Member& member : test.members) least = std::min(least, member.p);
    p_values.push_back(std::min(1.0, least * static_cast<double>(test.members.size())));
  }
  const std::vector<double> adjusted = holm(p_values);
  for (std::size_t f = 0; f < families.size(); ++f) {
    FamilyTest& test = families[f];
    test.p = adjusted[f];
    test.is_rejected = test.p <= 1.0 - level;
    const double holm_factor = p_values[f] > 0.0 ? adjusted[f] / p_values[f] : 1.0;
    test.member_limit =
        (1.0 - level) / (std::max(holm_factor, 1.0) * static_cast<double>(test.members.size()));
  }
}

std::vector<FamilyTest> judge_tests(std::vector<MemberTest> tests, double level) {
  std::ranges::stable_sort(tests, {}, &MemberTest::family);
  std::vector<FamilyTest> families;
  for (const MemberTest& one : tests) {
    if (families.empty() || families.back().family != one.family) {
      families.push_back({.family = one.family, .members = {}});
    }
    families.back().members.push_back(one.member);
  }
  auto next = tests.begin();
  for (FamilyTest& family : families) {
    const auto count = static_cast<double>(families.size() * family.members.size());
    for (Member& member : family.members) {
      member.interval = next->interval(level);
      member.simultaneous = next->interval(1.0 - (1.0 - level) / count);
      ++next;
    }
  }
  judge_together(families, level);
  next = tests.begin();
  for (FamilyTest& family : families) {
    for (Member& member : family.members) {
      if (family.is_shown(member)) member.shown = next->interval(1.0 - family.member_limit);
      ++next;
    }
  }
  return families;
}

namespace {

bool is_inside(const Interval& interval, const Interval& margin) {
  return interval.lower >= margin.lower && interval.upper <= margin.upper;
}

bool is_outside(const Interval& interval, const Interval& margin) {
  return interval.lower > margin.upper || interval.upper < margin.lower;
}

/// The condition on the members of a family for the answer "consistent".
enum class Deviation {
  is_inside,  ///< all members are shown to be within the margin
  /// No member is shown to be beyond the margin: there are too many to be shown inside.
  is_not_outside,
  none
};

Deviation claim_of(Family family) {
  switch (family) {
    case Family::size:
    case Family::component:
    case Family::stretch:
    case Family::bias:
    case Family::correlation:
      return Deviation::is_inside;
    case Family::tails:
      return Deviation::none;
    default:
      return Deviation::is_not_outside;
  }
}

/// The range of negligible values of members of a family, for a margin of ratios. A bias b adds b^2
/// to a ratio.
Interval margin_of(Family family, double within) {
  if (is_ratio(family)) return {1.0 / within, within};
  const bool is_bias = family == Family::bias || family == Family::bias_by_stretch;
  const double most = is_bias ? std::sqrt(within - 1.0) : within - 1.0;
  return {-most, most};
}

}  // namespace

bool is_beyond_margin(Family family, const Member& member, double within) {
  return claim_of(family) != Deviation::none &&
         is_outside(member.simultaneous, margin_of(family, within));
}

bool is_within_margin(Family family, const Member& member, double within) {
  return is_inside(member.interval, margin_of(family, within));
}

namespace {

template <class Predicate>
bool is_any_member(const Verdict& verdict, const Predicate& predicate) {
  return std::ranges::any_of(verdict.families, [&](const FamilyTest& test) {
    return std::ranges::any_of(
        test.members, [&](const Member& member) { return predicate(test.family, member); });
  });
}

bool is_within_margin(const Verdict& verdict) {
  const auto spoils = [&](Family family, const Member& member) {
    const bool is_proved = claim_of(family) != Deviation::is_inside ||
                           is_within_margin(family, member, verdict.within);
    return !is_proved || is_beyond_margin(family, member, verdict.within);
  };
  return verdict.find(Family::size) != nullptr && !is_any_member(verdict, spoils);
}

/// The answer by what is shown to be off.
Answer shown_answer(const Verdict& verdict) {
  bool is_above = false, is_below = false, is_rejected = false;
  for (const FamilyTest& test : verdict.families) {
    if (claim_of(test.family) == Deviation::none) continue;
    is_rejected = is_rejected || test.is_rejected;
    if (!is_ratio(test.family)) continue;
    for (const Member& member : test.members) {
      if (!test.is_shown(member)) continue;
      (member.estimate > 1.0 ? is_above : is_below) = true;
    }
  }
  if (is_above != is_below) return is_above ? Answer::optimistic : Answer::conservative;
  return is_rejected ? Answer::inconsistent : Answer::undecided;
}

Answer answer_of_tests(const Verdict& verdict) {
  if (verdict.families.empty()) return Answer::untested;
  return is_within_margin(verdict) ? Answer::consistent : shown_answer(verdict);
}

Answer answer_of(const Verdict& verdict) {
  if (verdict.beside.repeated_runs > 0) return Answer::untested;
  return verdict.beside.exact.empty() ? verdict.of_tests : Answer::inconsistent;
}

bool is_refused(const Verdict& verdict) {
  if (verdict.answer == Answer::untested || verdict.answer == Answer::consistent) return false;
  return !verdict.beside.exact.empty() ||
         is_any_member(verdict, [&](Family family, const Member& member) {
           return is_beyond_margin(family, member, verdict.within);
         });
}

/// Converts a value to the scale on which intervals are symmetric.
double on_scale(Family family, double value) { return is_ratio(family) ? std::log(value) : value; }

/// The shorter of the distances from the estimate to the ends of its interval: the part of the
/// longer one that comes from skewness decreases faster than the rest with more runs.
double half_of(Family family, const Member& member, const Interval& interval) {
  const double estimate = on_scale(family, member.estimate);
  return std::min(on_scale(family, interval.upper) - estimate,
                  estimate - on_scale(family, interval.lower));
}

/// Factor by which the number of runs must grow until the interval of a member lies within the
/// margin. The true value is taken to be the estimate, moved towards the right value by the part of
/// the distance that chance explains. `chance` is that of the farthest of all members, in half
/// intervals.
double growth_until_inside(Family family, const Member& member, double within, double chance) {
  const Interval margin = margin_of(family, within);
  if (claim_of(family) != Deviation::is_inside || is_inside(member.interval, margin)) return 1.0;
  const double half = half_of(family, member, member.interval);
  const double distance = std::abs(on_scale(family, member.estimate));
  constexpr double kBeyondChance = 1.5;  // chance hardly explains a larger deviation
  const double room =
      on_scale(family, margin.upper) - std::max(0.0, distance - kBeyondChance * chance * half);
  return room > 0.0 ? std::pow((1.0 + chance) * half / room, 2) : kNaN;
}

/// Factor by which the number of runs must grow until a member is shown to be beyond the margin;
/// NaN if chance explains that its estimate is beyond.
double growth_until_outside(Family family, const Member& member, double within, double chance) {
  if (claim_of(family) == Deviation::none) return kNaN;
  const double own = half_of(family, member, member.interval);
  const double beyond = std::abs(on_scale(family, member.estimate)) - chance * own -
                        on_scale(family, margin_of(family, within).upper);
  const double half = half_of(family, member, member.simultaneous);
  return beyond > 0.0 ? std::pow(half / beyond, 2) : kNaN;
}

/// The deviation, in halves of intervals, that the farthest of `members` estimates exceeds in half
/// of the studies.
double chance_of_farthest(double members, double level) {
  const double inside = std::pow(0.5, 1.0 / members);  // probability of each to be inside
  return normal_quantile(0.5 + 0.5 * inside) / normal_quantile(0.5 + 0.5 * level);
}

/// Number of members that must lie inside their margins.
double members_inside(const Verdict& verdict) {
  double members = 0.0;
  for (const FamilyTest& test : verdict.families) {
    if (claim_of(test.family) == Deviation::is_inside)
      members += static_cast<double>(test.members.size());
  }
  return members;
}

std::optional<std::uint64_t> more_runs_of(const Verdict& verdict, std::uint64_t runs) {
  double inside = 1.0, outside = kNaN;
  const double chance = chance_of_farthest(members_inside(verdict), verdict.level);
  for (const FamilyTest& test : verdict.families) {
    const double of_family =
        chance_of_farthest(static_cast<double>(test.members.size()), verdict.level);
    for (const Member& member : test.members) {
      const double growth = growth_until_inside(test.family, member, verdict.within, chance);
      inside = std::isnan(growth) ? growth : inside * std::max(1.0, growth / inside);
      outside =
          std::fmin(outside, growth_until_outside(test.family, member, verdict.within, of_family));
    }
  }
  constexpr double kMost = 1e9, kLeastGrowth = 1.1;
  const double growth = std::max(std::fmin(inside, outside), kLeastGrowth);
  const double more = std::ceil((growth - 1.0) * static_cast<double>(runs));
  if (!(more < kMost)) return std::nullopt;
  return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(more));
}

}  // namespace

std::string name_of(Answer answer) {
  constexpr std::array kNames = {"untested",     "consistent",   "optimistic",
                                 "conservative", "inconsistent", "undecided"};
  return kNames.at(static_cast<std::size_t>(answer));
}

bool Verdict::has_finding() const {
  return answer == Answer::optimistic || answer == Answer::conservative ||
         answer == Answer::inconsistent;
}

bool Verdict::is_slight() const { return has_finding() && !is_refused && beside.exact.empty(); }

std::string answer_in_words(const Verdict& verdict) {
  return (verdict.is_slight() ? "slightly " : "") + name_of(verdict.answer);
}

const FamilyTest* Verdict::find(Family family) const {
  const auto found = std::ranges::find(families, family, &FamilyTest::family);
  return found == families.end() ? nullptr : &*found;
}

Interval Verdict::ratio() const {
  const FamilyTest* size = find(Family::size);
  return size == nullptr ? Interval{kNaN, kNaN} : size->members.front().interval;
}

double Verdict::ratio_estimate() const {
  const FamilyTest* size = find(Family::size);
  return size == nullptr ? kNaN : size->members.front().estimate;
}

Verdict judge(std::vector<FamilyTest> families, double level, double within, std::uint64_t runs,
              BesideTests beside) {
  Verdict verdict{.level = level,
                  .within = within,
                  .families = std::move(families),
                  .beside = std::move(beside)};
  verdict.runs = runs;
  verdict.of_tests = answer_of_tests(verdict);
  verdict.answer = answer_of(verdict);
  verdict.is_refused = is_refused(verdict);
  const bool is_open = verdict.answer != Answer::untested && verdict.answer != Answer::consistent &&
                       !verdict.is_refused;
  if (is_open && runs >= kFewestRunsOfAPlan) verdict.more_runs = more_runs_of(verdict, runs);
  return verdict;
}

void take_for_upper_bounds(Verdict& verdict) {
  std::erase_if(verdict.families, [](const FamilyTest& test) {
    const bool is_bias = test.family == Family::bias || test.family == Family::bias_by_stretch;
    return !is_ratio(test.family) && !is_bias;
  });
  for (FamilyTest& test : verdict.families) {
    for (Member& member : test.members) {
      if (is_ratio(test.family) && member.estimate < 1.0) member.p = 1.0;
    }
  }
  judge_together(verdict.families, verdict.level);
  verdict.is_by_upper_bounds = true;
  verdict.of_tests = answer_of_tests(verdict);
  if (verdict.of_tests == Answer::consistent) verdict.of_tests = Answer::undecided;
  verdict.answer = answer_of(verdict);
  verdict.is_refused = is_refused(verdict);
  verdict.more_runs.reset();
}

void take_for_white_drives(const Verdict& of_any_memory, Verdict& verdict) {
  Interval& range = verdict.over_drives;
  range = of_any_memory.ratio();
  const bool is_within = is_inside(range, margin_of(Family::size, verdict.within));
  for (const FamilyTest& test : of_any_memory.families) {
    if (test.family != Family::component || !is_within) continue;  // the ratio of all leads
    for (const Member& member : test.members) {
      range = {std::min(range.lower, member.interval.lower),
               std::max(range.upper, member.interval.upper)};
    }
  }
  const bool is_open =
      verdict.of_tests == Answer::consistent && of_any_memory.of_tests != Answer::consistent;
  if (!is_open) return;
  verdict.of_tests = shown_answer(verdict);
  verdict.answer = answer_of(verdict);
  verdict.is_refused = is_refused(verdict);
}

void refuse_by_bets(Side side, Verdict& verdict) {
  if (verdict.answer == Answer::consistent || verdict.answer == Answer::untested) return;
  verdict.is_refused = true;
  verdict.refused_by_bets = side;
  verdict.more_runs.reset();
  if (verdict.of_tests != Answer::undecided) return;
  verdict.of_tests = side == Side::above ? Answer::optimistic : Answer::conservative;
  verdict.answer = answer_of(verdict);
}

GateAnswer gate(const Verdict& verdict, const Allowance& allowed) {
  if (verdict.beside.repeated_runs > 0) {
    throw StudyError(
        "the errors of run {} are those of run {} (runs must be independent): give each run once",
        verdict.beside.first_repeat.first, verdict.beside.first_repeat.second);
  }
  if (verdict.failed > allowed.failed || verdict.unusable > allowed.unusable) {
    return GateAnswer::inconsistent;
  }
  if (verdict.answer == Answer::untested) {
    throw StudyError(
        "no errors to judge (no complete run, no covariance, or too few effective draws at all "
        "scans): make more runs, have covariance in record.columns, or take more particles");
  }
  if (verdict.answer == Answer::consistent) return GateAnswer::consistent;
  return verdict.is_refused ? GateAnswer::inconsistent : GateAnswer::undecided;
}

}  // namespace montecarta::analysis
