// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/verdict.hpp"

#include "analysis/output/number_text.hpp"
#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/paired_tests.hpp"
#include "engine/errors.hpp"
#include "engine/runs/monte_carlo.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

namespace montecarta::analysis {

std::optional<std::string> study_setting(const std::string& study_text, std::string_view key) {
  const std::string beginning = std::string(key) + " = ";
  std::istringstream lines(study_text);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('[')) inside = line == "[study]";
    if (inside && line.starts_with(beginning)) return line.substr(beginning.size());
  }
  return std::nullopt;
}

double margin_in(const std::string& study_text) {
  const auto text = study_setting(study_text, "within");
  if (!text) return kUsualMargin;
  double margin = 0.0;
  const char* const last = text->data() + text->size();
  const auto [end, error] = std::from_chars(text->data(), last, margin);
  const bool is_good = error == std::errc() && end == last && margin >= kLeastMargin;
  if (is_good && margin <= kMostMargin) return margin;
  throw StudyError("study.within = " + *text +
                   " (a ratio from 1.001 to 100 is needed): choose another file");
}

std::vector<std::uint64_t> looks_in(const std::string& study_text, std::uint64_t runs) {
  const std::string until = study_setting(study_text, "until").value_or("");
  const std::string with_runs = std::string(kUntilVerdict) + ", ";  // "verdict, 100 runs"
  if (until != kUntilVerdict && !until.starts_with(with_runs)) return {};
  return rounds_of(runs);
}

std::string name_of(Family family) {
  constexpr std::array kNames = {"size", "component",   "stretch",     "scan",
                                 "bias", "correlation", "between runs"};
  return kNames.at(static_cast<std::size_t>(family));
}

std::string key_of(Family family) {
  std::string key = name_of(family);
  std::ranges::replace(key, ' ', '_');
  return key;
}

std::string name_of(const Member& member) {
  if (!member.name.empty()) return member.name;
  if (member.from == member.to) return "at " + fixed_seconds(member.from);
  return readable(member.from) + " s to " + readable(member.to) + " s";
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

MemberTest ratio_test(Family family, Member member, const SquaresLaw& law) {
  const double ratio = member.estimate;
  member.p = law.p_value(ratio);
  return {family, std::move(member),
          [law, ratio](double level) { return law.interval(ratio, level); }};
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
  return families;
}

double spent(double alpha, double information) {
  if (!(information > 0.0)) return 0.0;
  return 2.0 * normal_cdf(normal_quantile(0.5 * alpha) / std::sqrt(information));
}

double level_of_look(double level, std::span<const std::uint64_t> looks, std::uint64_t runs) {
  if (looks.size() < 2) return level;
  const auto look = std::min(std::ranges::lower_bound(looks, runs), looks.end() - 1);
  const auto information = [&](std::uint64_t n) {
    return static_cast<double>(n) / static_cast<double>(looks.back());
  };
  constexpr double kLeastSpent = 1e-10;  // a level nearer to 1 has no exact complement
  const double before = look == looks.begin() ? 0.0 : spent(1.0 - level, information(*(look - 1)));
  return 1.0 - std::max(spent(1.0 - level, information(*look)) - before, kLeastSpent);
}

namespace {

bool is_inside(const Interval& interval, const Interval& margin) {
  return interval.lower >= margin.lower && interval.upper <= margin.upper;
}

bool is_outside(const Interval& interval, const Interval& margin) {
  return interval.lower > margin.upper || interval.upper < margin.lower;
}

/// The range of negligible deviations of members of a family, for a margin of ratios.
Interval margin_of(Family family, double within) {
  if (is_ratio(family)) return {1.0 / within, within};
  const double most = family == Family::bias ? std::sqrt(within - 1.0) : within - 1.0;
  return {-most, most};
}

/// Returns whether a member allows the answer "consistent": shown to be within the margin, or, of
/// scans and the spread between runs, not shown to be beyond it.
bool allows_consistency(Family family, const Member& member, double within) {
  const Interval margin = margin_of(family, within);
  if (family == Family::scan || family == Family::between_runs) {
    return !is_outside(member.simultaneous, margin);
  }
  return is_inside(member.interval, margin);
}

bool is_within_margin(const Verdict& verdict) {
  if (verdict.find(Family::size) == nullptr) return false;
  return std::ranges::all_of(verdict.families, [&](const FamilyTest& test) {
    return std::ranges::all_of(test.members, [&](const Member& member) {
      return allows_consistency(test.family, member, verdict.within);
    });
  });
}

Answer answer_of(const Verdict& verdict) {
  if (verdict.families.empty()) return Answer::untested;
  if (is_within_margin(verdict)) return Answer::consistent;
  bool is_above = false, is_below = false, is_rejected = false;
  for (const FamilyTest& test : verdict.families) {
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

/// Factor by which the number of runs must grow until the interval of a member that exceeds the
/// margin is so short that it lies within the margin or shows a deviation among all tests.
double growth_needed(Family family, const Member& member, double within) {
  if (family == Family::scan || family == Family::between_runs) return 1.0;
  const Interval margin = margin_of(family, within), found = member.simultaneous;
  if (is_inside(member.interval, margin)) return 1.0;
  const double length =
      is_ratio(family) ? std::log(found.upper / found.lower) : found.upper - found.lower;
  const double wanted = is_ratio(family) ? std::log(within) : margin.upper;
  return (length / wanted) * (length / wanted);
}

std::optional<std::uint64_t> more_runs_of(const Verdict& verdict, std::uint64_t runs) {
  double growth = 1.0;
  for (const FamilyTest& test : verdict.families) {
    for (const Member& member : test.members) {
      growth = std::max(growth, growth_needed(test.family, member, verdict.within));
    }
  }
  constexpr double kMost = 1e9, kLeastGrowth = 1.1;
  growth = std::max(growth, kLeastGrowth);
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

Verdict judge(std::vector<FamilyTest> families, double level, double within, std::uint64_t runs) {
  Verdict verdict{.level = level, .within = within, .families = std::move(families)};
  verdict.runs = runs;
  verdict.answer = answer_of(verdict);
  const bool are_few = runs < kFewestRunsOfTraces;  // how many decide is not known from so few
  if (verdict.answer == Answer::undecided) {
    verdict.more_runs = are_few ? kFewestRunsOfTraces - runs : more_runs_of(verdict, runs);
  }
  return verdict;
}

GateAnswer gate(const Verdict& verdict, const Allowance& allowed) {
  if (verdict.failed > allowed.failed || verdict.unusable > allowed.unusable) {
    return GateAnswer::inconsistent;
  }
  switch (verdict.answer) {
    case Answer::untested:
      throw StudyError(
          "no errors to judge (no complete run, no covariance, or too few effective draws at all "
          "scans): make more runs, have covariance in record.columns, or take more particles");
    case Answer::consistent:
      return GateAnswer::consistent;
    case Answer::undecided:
      return GateAnswer::undecided;
    default:
      return GateAnswer::inconsistent;
  }
}

}  // namespace montecarta::analysis
