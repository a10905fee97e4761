// SPDX-License-Identifier: BSD-3-Clause
// The verdict in words: short for a table, and as a sentence with time and component.
#include "analysis/verdict/sentence.hpp"

#include "analysis/statistics/interval.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr double kMostToPrint = 1e20;  // beyond this a factor only means that it is large

constexpr std::array kSides = {Side::above, Side::below};

/// A member with its family.
struct ShownMember {
  const FamilyTest* test;
  const Member* member;
};

bool is_rejected(const Verdict& verdict, Family family) {
  const FamilyTest* test = verdict.find(family);
  return test != nullptr && test->is_rejected;
}

/// Members of a family of ratios that are shown to be off in one direction.
std::vector<const Member*> shown_in(const FamilyTest* test, Side direction) {
  std::vector<const Member*> all;
  if (test == nullptr) return all;
  for (const Member& member : test->members) {
    const bool is_above = member.estimate > 1.0;
    if (test->is_shown(member) && is_above == (direction == Side::above)) {
      all.push_back(&member);
    }
  }
  return all;
}

/// The interval that shows a member to be off; the simultaneous one if there is none.
const Interval& shown_interval(const Member& member) {
  return std::isnan(member.shown.lower) ? member.simultaneous : member.shown;
}

/// The member that a sentence names for a direction, of those that are shown: one that is beyond
/// the margin before one that is not, a single scan last, the size first, then by the least
/// p-value. The size counts as beyond the margin unless it is shown to lie within.
std::optional<ShownMember> leading(const Verdict& verdict, Side direction) {
  const auto rank = [&](const ShownMember& one) {
    const Family family = one.test->family;
    const bool is_size = family == Family::size;
    const bool is_decisive = is_size ? !is_within_margin(family, *one.member, verdict.within)
                                     : is_beyond_margin(family, *one.member, verdict.within);
    return std::tuple(is_decisive, family != Family::scan, is_size, -one.member->p);
  };
  std::optional<ShownMember> best;
  for (const FamilyTest& test : verdict.families) {
    if (!is_ratio(test.family)) continue;
    for (const Member* member : shown_in(&test, direction)) {
      const ShownMember one{&test, member};
      if (!best || rank(one) > rank(*best)) best = one;
    }
  }
  return best;
}

std::string from_to(double lower, double upper) {
  if (std::isinf(lower) || lower > kMostToPrint) return "more than " + compact(kMostToPrint);
  const std::string from = compact(lower), to = compact(upper);
  if (std::isinf(upper) || upper > kMostToPrint) return "at least " + from;
  return from == to ? from : from + " to " + to;
}

/// Text of a factor, "1.28 to 2.25", above 1 in both directions. The size has an interval of its
/// own; other members were chosen among many.
std::string factor_text(const ShownMember& shown, Side direction, bool is_slight = false) {
  const bool is_alone = shown.test->family == Family::size || is_slight;
  Interval ratio = is_alone ? shown.member->interval : shown_interval(*shown.member);
  if (direction == Side::below) ratio = {1.0 / ratio.upper, 1.0 / ratio.lower};
  return from_to(std::max(ratio.lower, 1.0), ratio.upper);
}

/// Text of a component: "forward", "in heading".
std::string in_component(const std::string& name) {
  return name == "forward" || name == "left" ? name : "in " + name;
}

/// Text of a member's component and time: " in heading", " from 12 s to 24 s", " in heading from 12
/// s to 24 s", " at 3 s"; empty for the size.
std::string place_of(const Member& member, bool is_of_component) {
  std::string name = is_of_component ? " " + in_component(member.name) : "";
  if (std::isnan(member.from)) return name;
  Member time = member;
  time.name.clear();
  return name + (member.from == member.to ? " " : " from ") + name_of(time);
}

std::string place_of(const ShownMember& shown) {
  const Family family = shown.test->family;
  if (family == Family::size) return "";
  const bool is_of_component =
      family == Family::component || family == Family::component_by_stretch;
  return place_of(*shown.member, is_of_component);
}

/// Text of the times at which stretches are off: "from 138 s on"; empty if no stretch is shown, or
/// if stretches do not differ.
std::string when(const Verdict& verdict, Side direction) {
  const FamilyTest* stretches = verdict.find(Family::stretch);
  const auto shown = shown_in(stretches, direction);
  if (shown.empty()) return "";
  const bool from_start = shown.front() == &stretches->members.front();
  const bool to_end = shown.back() == &stretches->members.back();
  const auto gap = static_cast<std::size_t>(shown.back() - shown.front()) + 1;
  if (gap == shown.size() && to_end && from_start) return "in every eighth of the drive";
  if (verdict.beside.p_of_equal_stretches > 1.0 - verdict.level) return "";
  if (gap != shown.size()) return "at some times more than at others";
  const double origin = shown.front()->origin, from = shown.front()->from, to = shown.back()->to;
  if (to_end) return "from " + time_text(from, origin) + " on";
  if (from_start) return "until " + time_text(to, origin);
  return "from " + clock_text(from - origin) + " to " + time_text(to, origin);
}

double distance_of(const Member& ratio) { return std::abs(std::log(ratio.estimate)); }

bool are_apart(const Member& a, const Member& b) {
  return a.interval.upper < b.interval.lower || a.interval.lower > b.interval.upper;
}

/// The components that are off more than half as far, in logarithms, as the one that is off most.
std::vector<const Member*> farthest_of(const std::vector<const Member*>& shown) {
  double most = 0.0;
  for (const Member* member : shown) most = std::max(most, distance_of(*member));
  std::vector<const Member*> all;
  for (const Member* member : shown) {
    if (distance_of(*member) >= 0.5 * most) all.push_back(member);
  }
  return all;
}

/// Text of a list: "z, rx and ry".
std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k) {
    text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
  }
  return text;
}

/// Text of the worst components: ", mainly in heading (1.9 to 2.4 times)"; empty if components do
/// not differ.
std::string where(const Verdict& verdict, Side direction) {
  const FamilyTest* components = verdict.find(Family::component);
  const auto farthest = farthest_of(shown_in(components, direction));
  if (farthest.empty() || farthest.size() == components->members.size()) return "";
  for (const Member& other : components->members) {
    const bool is_one = std::ranges::count(farthest, &other) > 0;
    const auto is_apart = [&](const Member* one) { return are_apart(*one, other); };
    if (!is_one && !std::ranges::all_of(farthest, is_apart)) return "";
  }
  std::vector<std::string> names;
  for (const Member* one : farthest) names.push_back(one->name);
  if (names.size() > 1) return ", mainly in " + listed(names);
  if (farthest.front()->estimate == 0.0)
    return ", mainly " + in_component(names.front()) + ", where its errors are all exactly 0";
  return ", mainly " + in_component(names.front()) + " (" +
         factor_text({components, farthest.front()}, direction) + " times)";
}

/// Text of an interval of a signed number: "-0.54 to -0.40", "0.40 or more".
std::string signed_text(const Interval& found) {
  const auto text = [](double value) { return readable(value, 2); };
  if (std::isinf(found.lower)) return text(found.upper) + " or less";
  if (std::isinf(found.upper)) return text(found.lower) + " or more";
  return text(found.lower) + " to " + text(found.upper);
}

/// The shown member with the least p-value among those whose estimate has that sign; nullptr if
/// there is none.
const Member* strongest_shown(const FamilyTest& test, bool is_negative) {
  const Member* best = nullptr;
  for (const Member& member : test.members) {
    if (!test.is_shown(member) || (member.estimate < 0.0) != is_negative) continue;
    if (best == nullptr || member.p < best->p) best = &member;
  }
  return best;
}

std::string bias_of(const Member& member) {
  return "a bias" + place_of(member, true) + " of " + signed_text(shown_interval(member)) +
         " standard deviations";
}

std::string correlation_of(const Member& member) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Interval found = shown_interval(member);  // an end beyond 1 excludes nothing
  if (found.lower < -1.0) found.lower = -kInfinity;
  if (found.upper > 1.0) found.upper = kInfinity;
  return "an unreported correlation of " + signed_text(found) + " between " + member.name +
         place_of(member, false);
}

/// Texts of biases or correlations: over the whole drive if those are shown, else of the strongest
/// stretch of each sign.
template <class Words>
void add_zero_means(const Verdict& verdict, Family whole, Family by_stretch, Words words,
                    std::vector<std::string>& all) {
  const FamilyTest* test = verdict.find(is_rejected(verdict, whole) ? whole : by_stretch);
  if (test == nullptr) return;
  for (const bool is_negative : {false, true}) {
    const Member* member = strongest_shown(*test, is_negative);
    if (member != nullptr) all.push_back(words(*member));
  }
}

std::string spread_words(const Verdict& verdict) {
  const FamilyTest* test = verdict.find(Family::between_runs);
  if (test == nullptr || !test->is_rejected) return "";
  const Interval& found = test->members.front().interval;
  return "runs have scales of their own (their mean squared errors differ by a standard deviation "
         "of " +
         signed_text(found) + ")";
}

/// Text of heavy tails: "its errors have heavier tails than a Gaussian (the largest is 12.3
/// deviations, of heading of run 17 at 31.0 s)". Runs with scales of their own have such tails too,
/// and are described by their spread.
std::string tail_words(const Verdict& verdict) {
  const FamilyTest* test = verdict.find(Family::tails);
  if (test == nullptr || !test->is_rejected || !spread_words(verdict).empty()) return "";
  std::string words = "its errors have heavier tails than a Gaussian";
  const Member& largest = test->members.back();
  if (!test->is_shown(largest)) return words;
  return words + " (the largest is " + compact(largest.estimate) + " deviations, of " +
         name_of(largest) + ")";
}

/// Texts of biases and correlations, in the order of their lengths.
std::vector<std::string> means_words(const Verdict& verdict) {
  std::vector<std::string> all;
  add_zero_means(verdict, Family::bias, Family::bias_by_stretch, bias_of, all);
  add_zero_means(verdict, Family::correlation, Family::correlation_by_stretch, correlation_of, all);
  std::ranges::stable_sort(all, {}, &std::string::size);
  return all;
}

std::string joined(const std::vector<std::string>& phrases) {
  std::string text;
  for (const std::string& phrase : phrases) {
    if (!phrase.empty()) append_part(text, phrase, "; ");
  }
  return text;
}

/// Text of a refusal by bets, which do not name the ratio that is off; empty if bets refuse
/// nothing.
std::string bet_words(const Verdict& verdict) {
  if (!verdict.refused_by_bets) return "";
  const bool is_above = verdict.refused_by_bets == Side::above;
  return "bets on its runs show that squared errors, of all or of a component or of an eighth of "
         "the drive, are more than " +
         exact_text(verdict.within) +
         (is_above ? " times what it claims" : " times smaller than it claims");
}

/// Text of all ratios that are off in one direction: "on average its squared errors are 1.67 times
/// what it claims (95 %: 1.28 to 2.25), shown from 138 s on, mainly forward (2.1 to 3.4 times)";
/// empty if nothing is shown in this direction.
std::string ratio_sentence(const Verdict& verdict, Side direction) {
  const auto shown = leading(verdict, direction);
  const bool is_above = direction == Side::above;
  if (!shown) return "";
  const std::string factor = factor_text(*shown, direction);
  const std::string than = is_above ? " times what it claims" : " times smaller than it claims";
  const std::string place = place_of(*shown);
  const double ratio = shown->member->estimate;
  if (ratio == 0.0) return "its errors" + place + " are all exactly 0";
  if (!place.empty()) return "its squared errors" + place + " are " + factor + than;
  const std::string time = when(verdict, direction);
  return "on average its squared errors are " + compact(is_above ? ratio : 1.0 / ratio) + than +
         " (" + level_text(verdict.level) + ": " + factor + ")" +
         (time.empty() ? "" : ", shown " + time) + where(verdict, direction);
}

/// Text of everything that is shown, with the spread between runs first if directions differ.
std::string shown_sentence(const Verdict& verdict) {
  const std::string spread = spread_words(verdict), above = ratio_sentence(verdict, Side::above),
                    below = ratio_sentence(verdict, Side::below);
  const bool is_one_direction = above.empty() != below.empty();
  std::vector<std::string> phrases = {is_one_direction ? above + below : spread,
                                      is_one_direction ? spread : above,
                                      is_one_direction ? "" : below};
  std::ranges::move(means_words(verdict), std::back_inserter(phrases));
  phrases.push_back(bet_words(verdict));
  phrases.push_back(tail_words(verdict));
  return joined(phrases);
}

/// Text of the leading ratio in one direction: "NEES 1.28 to 2.25 times too large in heading".
std::string ratio_words(const Verdict& verdict, Side direction) {
  const auto shown = leading(verdict, direction);
  if (!shown) return "";
  const std::string time =
      shown->test->family == Family::size ? when(verdict, direction) : std::string();
  return (verdict.is_of_innovations ? "NIS " : "NEES ") + factor_text(*shown, direction) +
         (direction == Side::above ? " times too large" : " times too small") + place_of(*shown) +
         (time.empty() ? "" : ", " + time);
}

/// Text of the findings besides the leading one: "bias, correlation, between runs". Unlike the
/// sentence, it does not distinguish findings in a stretch from those over the whole drive.
std::string also_words(const Verdict& verdict) {
  constexpr std::array<std::pair<const char*, std::array<Family, 2>>, 4> kFindings = {
      {{"bias", {Family::bias, Family::bias_by_stretch}},
       {"correlation", {Family::correlation, Family::correlation_by_stretch}},
       {"between runs", {Family::between_runs, Family::between_runs}},
       {"tails", {Family::tails, Family::tails}}}};
  std::string names;
  for (const auto& [name, families] : kFindings) {
    const auto is_found = [&](Family family) { return is_rejected(verdict, family); };
    if (std::ranges::any_of(families, is_found)) append_part(names, name);
  }
  return names;
}

std::string shown_words(const Verdict& verdict) {
  const std::string above = ratio_words(verdict, Side::above);
  const std::string below = ratio_words(verdict, Side::below);
  std::string ratios = above.empty() ? below : above;
  if (!above.empty() && !below.empty()) ratios += ", " + below.substr(below.find(' ') + 1);
  const std::string also = also_words(verdict);
  if (ratios.empty()) return shown_sentence(verdict);
  if (also.empty()) return ratios;
  return ratios + "; also " + also;
}

/// Text of a deviation that is shown within the margin: ", slightly optimistic (1.02 to 1.06)", ",
/// though with a bias in heading of ...".
std::string slight_words(const Verdict& verdict) {
  std::string words;
  for (const Side direction : kSides) {
    const auto shown = leading(verdict, direction);
    if (!shown) continue;
    const bool is_above = direction == Side::above;
    words += std::string(", slightly ") + (is_above ? "optimistic" : "conservative") +
             place_of(*shown) + " (" + factor_text(*shown, direction, true) + ")";
  }
  std::vector<std::string> phrases = means_words(verdict);
  phrases.insert(phrases.begin(), spread_words(verdict));
  std::erase(phrases, "");
  if (phrases.empty()) return words;
  return words + ", though " + (phrases.front().starts_with('a') ? "with " : "") + listed(phrases);
}

/// Text of failures: "3 of 300 runs failed, 20 of 9600 samples are unusable"; empty if there are
/// none.
std::string exceptions_of(const Verdict& found) {
  std::string words;
  const auto add = [&](std::uint64_t count, std::uint64_t of, const std::string& what) {
    if (count == 0) return;
    append_part(words, std::to_string(count) + " of " + std::to_string(of) + what);
  };
  const auto samples = [](std::uint64_t count) {
    return count == 1 ? " samples is " : " samples are ";
  };
  add(found.failed, found.runs, " runs failed");
  add(found.unusable, found.samples, samples(found.unusable) + std::string("unusable"));
  add(found.missing, found.samples + found.missing,
      samples(found.missing) + std::string("missing"));
  return words;
}

std::uint64_t complete_runs(const Verdict& verdict) { return verdict.runs - verdict.failed; }

std::string within_words(const Verdict& verdict) {
  return "consistent within " + exact_text(verdict.within);
}

/// Text of the further runs needed: "about 130 more runs decide".
std::string more_runs_words(const Verdict& verdict) {
  if (complete_runs(verdict) < kFewestRunsOfAPlan) {
    return "take at least " + std::to_string(kFewestRunsOfAPlan) + " runs";
  }
  if (!verdict.more_runs) return "many more runs decide";
  return "about " + std::to_string(*verdict.more_runs) + " more runs decide";
}

/// Text of a deviation that is shown, but not shown to be beyond the margin.
std::string open_words(const Verdict& verdict) {
  return "it is not shown to be beyond the margin of " + exact_text(verdict.within) + ": " +
         more_runs_words(verdict);
}

std::string answer_words(const Verdict& verdict) {
  switch (verdict.of_tests) {
    case Answer::untested:
      return "not tested";
    case Answer::consistent:
      return within_words(verdict) + slight_words(verdict);
    case Answer::undecided:
      return name_of(verdict.of_tests) + ": " +
             (verdict.is_by_upper_bounds ? "no fault is shown" : more_runs_words(verdict));
    default:
      return answer_in_words(verdict) + ": " + shown_words(verdict);
  }
}

/// Text of the parts that were judged: "in every component and in every eighth of the drive".
std::string judged_parts(const Verdict& verdict) {
  const FamilyTest* bias = verdict.find(Family::bias);
  if (bias == nullptr) return " on average";
  const bool is_one = bias->members.size() == 1;
  std::string parts = is_one ? "" : " in every component";
  if (verdict.find(Family::stretch) != nullptr) {
    parts += (is_one ? "" : " and") + std::string(" in every eighth of the drive");
  }
  return parts;
}

/// Text of the parts that were not judged: "; correlations were not judged"; empty if everything
/// was.
std::string not_judged(const Verdict& verdict) {
  const FamilyTest* bias = verdict.find(Family::bias);
  if (bias == nullptr) return "; its components were not judged";
  const bool has_correlations =
      bias->members.size() == 1 || verdict.find(Family::correlation) != nullptr;
  return has_correlations ? "" : "; correlations were not judged";
}

/// Text of what few runs do not show; empty if there are enough runs to judge everything.
std::string few_runs_words(const Verdict& verdict) {
  if (complete_runs(verdict) >= kFewestJudgedRuns) return "";
  const std::string fewer = "of fewer than " + std::to_string(kFewestJudgedRuns) + " runs ";
  if (verdict.find(Family::size) == nullptr) return fewer + "single scans alone are judged";
  if (!std::isnan(verdict.over_drives.upper)) return fewer + "correlations are not judged";
  return fewer + (verdict.is_of_innovations ? "" : "bias, ") +
         "correlations and stretches of the drive are not judged";
}

std::string consistent_words(const Verdict& verdict) {
  if (!few_runs_words(verdict).empty()) {
    return within_words(verdict) + " along the drive" + slight_words(verdict) + "; " +
           few_runs_words(verdict);
  }
  const std::string tails = tail_words(verdict);
  return within_words(verdict) + judged_parts(verdict) + slight_words(verdict) +
         not_judged(verdict) + "; " +
         (tails.empty() ? "events rarer than 1 in " + std::to_string(complete_runs(verdict) / 3) +
                              " runs are not excluded"
                        : tails);
}

/// Text of the part whose interval reaches farthest beyond the margin, if that of the average does
/// not: " in heading from 10 s to 20 s, as it is on average".
std::string open_part(const Verdict& verdict) {
  const FamilyTest* size = verdict.find(Family::size);
  if (size == nullptr || !is_within_margin(Family::size, size->members.front(), verdict.within)) {
    return "";
  }
  const Member* farthest = nullptr;
  double most = 0.0;
  for (const FamilyTest& test : verdict.families) {
    if (!is_ratio(test.family) || test.family == Family::scan) continue;
    for (const Member& member : test.members) {
      const Interval& reach = member.interval;
      const double beyond = std::max(std::log(reach.upper), -std::log(reach.lower));
      if (is_within_margin(test.family, member, verdict.within) || !(beyond > most)) continue;
      most = beyond;
      farthest = &member;
    }
  }
  const std::string place = farthest == nullptr ? "" : name_of(*farthest);
  if (place.empty()) return "";
  const bool is_stretch = farthest->name.empty();
  return std::string(is_stretch ? " from " : " in ") + place + ", as it is on average";
}

/// Text on a few drives of white innovations, whose own size is known better than that of others.
std::string white_drives_words(const Verdict& verdict) {
  const std::uint64_t runs = complete_runs(verdict);
  const std::string drives = runs == 1 ? "this drive" : "these " + std::to_string(runs) + " drives";
  const auto range = [](const Interval& ratio) { return from_to(ratio.lower, ratio.upper); };
  return "undecided: no fault is shown; on " + drives + " its squared errors are " +
         compact(verdict.ratio_estimate()) + " times what it claims (" + level_text(verdict.level) +
         ": " + range(verdict.ratio()) +
         "); an error that lasts for a whole drive, and is small on " + drives +
         ", would not be seen: over many drives the ratio, or that of a component, is only known "
         "to be " +
         range(verdict.over_drives) + ", and not to be within " + exact_text(verdict.within);
}

std::string undecided_words(const Verdict& verdict) {
  if (verdict.is_by_upper_bounds) {
    return "undecided: its errors are not shown to be larger than they may be at most, which shows "
           "no fault and no consistency";
  }
  const std::uint64_t runs = complete_runs(verdict);
  const Interval& others = verdict.over_drives;
  if (others.upper > verdict.within || others.lower < 1.0 / verdict.within) {
    return joined({white_drives_words(verdict), few_runs_words(verdict), more_runs_words(verdict)});
  }
  const std::string words = "undecided: no fault is shown, and " + std::to_string(runs) +
                            (runs == 1 ? " run is" : " runs are") + " too few to show that it is " +
                            within_words(verdict);
  return joined({words + open_part(verdict), few_runs_words(verdict), more_runs_words(verdict),
                 tail_words(verdict)});
}

/// Text of the findings of the tests.
std::string tested_words(const Verdict& verdict) {
  const std::string slightly = verdict.is_slight() ? "slightly " : "";
  const std::string few = few_runs_words(verdict);
  const std::string open =
      (few.empty() ? "" : "; " + few) + (verdict.is_slight() ? "; " + open_words(verdict) : "");
  switch (verdict.of_tests) {
    case Answer::consistent:
      return consistent_words(verdict);
    case Answer::optimistic:
      return slightly + "optimistic (overconfident): " + shown_sentence(verdict) + open;
    case Answer::conservative:
      return slightly + "conservative: " + shown_sentence(verdict) + open;
    case Answer::inconsistent:
      return slightly + "inconsistent: " + shown_sentence(verdict) + open;
    case Answer::undecided:
      return undecided_words(verdict);
    case Answer::untested:
      break;
  }
  return "not tested: no complete run has a covariance that can be judged";
}

/// Text of errors of exact components: "z and rx have errors of up to 3e-08 and 1e-09 although
/// their reported deviation is 0".
std::string exact_words(const Verdict& verdict) {
  const auto& all = verdict.beside.exact;
  std::vector<std::string> names, errors;
  for (const BesideTests::Exact& exact : all) {
    names.push_back(exact.component);
    errors.push_back(compact(exact.error));
  }
  return "it claims a deviation of 0 for " + listed(names) + ", which " +
         (all.size() == 1 ? "has" : "have") + " errors of up to " + listed(errors);
}

std::string repeat_words(const Verdict& verdict) {
  const auto& [run, earlier] = verdict.beside.first_repeat;
  return "not tested: " + std::to_string(verdict.beside.repeated_runs) + " of " +
         std::to_string(complete_runs(verdict)) +
         (verdict.beside.repeated_runs == 1 ? " runs has" : " runs have") +
         " the errors of an earlier run, number by number (run " + std::to_string(run) +
         " those of run " + std::to_string(earlier) + "), and runs must be independent";
}

std::string all_words(const Verdict& verdict, const std::string& by_tests) {
  if (verdict.beside.repeated_runs > 0) return repeat_words(verdict);
  if (verdict.beside.exact.empty()) return by_tests;
  std::string of_exact = "inconsistent: " + exact_words(verdict);
  if (verdict.of_tests == Answer::untested) return of_exact;
  return of_exact + "; apart from that it is " + by_tests;
}

}  // namespace

std::string in_words(const Verdict& verdict) {
  const std::string exceptions = exceptions_of(verdict);
  std::string words = all_words(verdict, answer_words(verdict));
  if (exceptions.empty()) return words;
  const bool is_good = verdict.answer == Answer::consistent;
  return words + (is_good ? " in what can be judged" : "") + " (" + exceptions + ")";
}

std::string sentence(const std::string& label, const Verdict& verdict) {
  const std::string exceptions = exceptions_of(verdict);
  return label + " is " + all_words(verdict, tested_words(verdict)) +
         (exceptions.empty() ? "." : " (" + exceptions + ").");
}

}  // namespace montecarta::analysis
