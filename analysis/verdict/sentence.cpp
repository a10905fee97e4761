// SPDX-License-Identifier: BSD-3-Clause
// The verdict in words: short for a table, and as a sentence with time and component.
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/squares_law.hpp"
#include "analysis/verdict/verdict.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

enum class Direction { above, below };

/// A member with its family.
struct Shown {
  const FamilyTest* test;
  const Member* member;
};

/// Members of a family of ratios that are shown to be off in one direction.
std::vector<const Member*> shown_in(const FamilyTest* test, Direction direction) {
  std::vector<const Member*> all;
  if (test == nullptr) return all;
  for (const Member& member : test->members) {
    const bool is_above = member.estimate > 1.0;
    if (test->is_shown(member) && is_above == (direction == Direction::above)) {
      all.push_back(&member);
    }
  }
  return all;
}

/// The leading member for a direction: the size if it is shown, else the component or stretch of
/// the least p-value, else the scan.
std::optional<Shown> leading(const Verdict& verdict, Direction direction) {
  std::optional<Shown> best;
  for (const FamilyTest& test : verdict.families) {
    const bool is_settled =
        best && (best->test->family == Family::size || test.family == Family::scan);
    if (!is_ratio(test.family) || is_settled) continue;
    for (const Member* member : shown_in(&test, direction)) {
      if (!best || member->p < best->member->p) best = Shown{&test, member};
    }
  }
  return best;
}

std::string from_to(double lower, double upper) {
  if (std::isinf(lower)) return "infinitely many";
  const std::string from = compact(lower), to = compact(upper);
  if (std::isinf(upper)) return "at least " + from;
  return from == to ? from : from + " to " + to;
}

/// "1.28 to 2.25", larger than 1 in both directions. The size has an interval of its own; others
/// were chosen among many.
std::string factor_text(const Shown& shown, Direction direction, bool is_slight = false) {
  const bool is_alone = shown.test->family == Family::size || is_slight;
  Interval ratio = is_alone ? shown.member->interval : shown.member->simultaneous;
  if (direction == Direction::below) ratio = {1.0 / ratio.upper, 1.0 / ratio.lower};
  return from_to(std::max(ratio.lower, 1.0), ratio.upper);
}

/// "forward", "in heading"
std::string in_component(const std::string& name) {
  return name == "forward" || name == "left" ? name : "in " + name;
}

/// " in heading", " from 12 s to 24 s", " at 3 s"; empty for the size.
std::string place_of(const Shown& shown) {
  switch (shown.test->family) {
    case Family::component:
      return " " + in_component(shown.member->name);
    case Family::stretch:
      return " from " + name_of(*shown.member);
    case Family::scan:
      return " " + name_of(*shown.member);
    default:
      return "";
  }
}

/// "from 138 s on"; empty where no stretch is shown.
std::string when(const Verdict& verdict, Direction direction) {
  const FamilyTest* stretches = verdict.find(Family::stretch);
  const auto shown = shown_in(stretches, direction);
  if (shown.empty()) return "";
  const auto gap = static_cast<std::size_t>(shown.back() - shown.front()) + 1;
  if (gap != shown.size()) return "at some times more than at others";
  const bool from_start = shown.front() == &stretches->members.front();
  const bool to_end = shown.back() == &stretches->members.back();
  if (to_end && from_start) return "in every eighth of the drive";
  if (to_end) return "from " + readable(shown.front()->from) + " s on";
  if (from_start) return "until " + readable(shown.back()->to) + " s";
  return "from " + readable(shown.front()->from) + " s to " + readable(shown.back()->to) + " s";
}

/// ", mainly in heading"; empty where components do not differ.
std::string where(const Verdict& verdict, Direction direction) {
  const FamilyTest* components = verdict.find(Family::component);
  const auto shown = shown_in(components, direction);
  if (shown.empty()) return "";
  const auto distance = [](double ratio) { return std::abs(std::log(ratio)); };
  const auto farthest = *std::ranges::max_element(
      shown, {}, [&](const Member* member) { return distance(member->estimate); });
  const bool is_alone = std::ranges::all_of(components->members, [&](const Member& other) {
    const bool is_apart = other.interval.upper < farthest->interval.lower ||
                          other.interval.lower > farthest->interval.upper;
    return &other == farthest || is_apart;
  });
  return is_alone ? ", mainly " + in_component(farthest->name) : "";
}

/// "NEES 1.28 to 2.25 times too large in heading"
std::string ratio_words(const Verdict& verdict, Direction direction) {
  const auto shown = leading(verdict, direction);
  if (!shown) return "";
  return "NEES " + factor_text(*shown, direction) +
         (direction == Direction::above ? " times too large" : " times too small") +
         place_of(*shown);
}

/// The shown deviation with the least p-value among the families that are no ratios.
std::string other_words(const Verdict& verdict) {
  std::optional<Shown> best;
  for (const FamilyTest& test : verdict.families) {
    if (is_ratio(test.family)) continue;
    for (const Member& member : test.members) {
      if (test.is_shown(member) && (!best || member.p < best->member->p)) best = {&test, &member};
    }
  }
  if (!best) return "";
  const Interval& found = best->member->interval;
  const double low = std::min(std::abs(found.lower), std::abs(found.upper));
  const double high = std::max(std::abs(found.lower), std::abs(found.upper));
  const std::string range = from_to(low, high);
  switch (best->test->family) {
    case Family::bias:
      return "a bias " + in_component(best->member->name) + " of " + range + " standard deviations";
    case Family::correlation:
      return "a correlation of " + range + " between " + best->member->name +
             " that is not reported";
    default:
      return "scales of their own in single runs (standard deviation " + range + ")";
  }
}

/// Times at which the size is off, if the size alone leads the verdict.
std::string time_words(const Verdict& verdict, Direction direction) {
  const auto shown = leading(verdict, direction);
  const bool is_size = shown && shown->test->family == Family::size;
  const std::string time = is_size ? when(verdict, direction) : "";
  return time.empty() ? "" : ", " + time;
}

std::string inconsistent_words(const Verdict& verdict) {
  const std::string above = ratio_words(verdict, Direction::above);
  const std::string below = ratio_words(verdict, Direction::below);
  if (above.empty() || below.empty()) return other_words(verdict);
  return above + ", " + below.substr(below.find(' ') + 1);
}

/// ", slightly optimistic (1.02 to 1.06)", ", though with a bias in heading of ..." where a
/// deviation within the margin is shown.
std::string slight_words(const Verdict& verdict) {
  std::string words;
  for (const Direction direction : {Direction::above, Direction::below}) {
    const auto shown = leading(verdict, direction);
    if (!shown || shown->test->family == Family::scan) continue;
    const bool is_above = direction == Direction::above;
    words += std::string(", slightly ") + (is_above ? "optimistic" : "conservative") +
             place_of(*shown) + " (" + factor_text(*shown, direction, true) + ")";
  }
  const std::string others = other_words(verdict);
  return others.empty() ? words : words + ", though with " + others;
}

/// "3 of 300 runs failed, 20 of 9600 samples are unusable"; empty if there are none.
std::string exceptions_of(const Verdict& found) {
  std::string words;
  if (found.failed > 0) {
    words = std::to_string(found.failed) + " of " + std::to_string(found.runs) + " runs failed";
  }
  if (found.unusable > 0) {
    words += (words.empty() ? "" : ", ") + std::to_string(found.unusable) + " of " +
             std::to_string(found.samples) + " samples are unusable";
  }
  return words;
}

std::uint64_t complete_runs(const Verdict& verdict) { return verdict.runs - verdict.failed; }

std::string within_words(const Verdict& verdict) {
  return "consistent within " + exact_text(verdict.within);
}

std::string undecided_words(const Verdict& verdict) {
  if (complete_runs(verdict) < kFewestRunsOfTraces) {
    return ": take at least " + std::to_string(kFewestRunsOfTraces) + " runs";
  }
  if (!verdict.more_runs) return ": many more runs decide";
  return ": about " + std::to_string(*verdict.more_runs) + " more runs decide";
}

/// Direction of an optimistic or a conservative filter.
Direction direction_of(Answer answer) {
  return answer == Answer::optimistic ? Direction::above : Direction::below;
}

std::string answer_words(const Verdict& verdict) {
  const Direction direction = direction_of(verdict.answer);
  const std::string name = name_of(verdict.answer);
  switch (verdict.answer) {
    case Answer::untested:
      return "not tested";
    case Answer::consistent:
      return within_words(verdict) + slight_words(verdict);
    case Answer::inconsistent:
      return name + ": " + inconsistent_words(verdict);
    case Answer::undecided:
      return name + undecided_words(verdict);
    default:
      return name + ": " + ratio_words(verdict, direction) + time_words(verdict, direction);
  }
}

/// "on average its squared errors are 1.67 times what it claims (95 %: 1.28 to 2.25), shown from
/// 138 s on, mainly forward"
std::string squared_errors(const Verdict& verdict) {
  const Direction direction = direction_of(verdict.answer);
  const auto shown = leading(verdict, direction);
  if (!shown) return "";
  const bool is_above = direction == Direction::above;
  const std::string factor = factor_text(*shown, direction);
  const std::string than = is_above ? " times what it claims" : " times smaller than it claims";
  const std::string place = place_of(*shown);
  if (!place.empty()) return "its squared errors" + place + " are " + factor + than;
  const double ratio = shown->member->estimate;
  const std::string time = when(verdict, direction);
  return "on average its squared errors are " + compact(is_above ? ratio : 1.0 / ratio) + than +
         " (" + level_text(verdict.level) + ": " + factor + ")" +
         (time.empty() ? "" : ", shown " + time) + where(verdict, direction);
}

std::string consistent_sentence(const std::string& label, const Verdict& verdict) {
  const std::string parts = verdict.find(Family::stretch) != nullptr
                                ? " in every component and in every eighth of the drive"
                                : " in every component";
  return label + " is " + within_words(verdict) + parts + slight_words(verdict) +
         "; events rarer than 1 in " + std::to_string(complete_runs(verdict) / 3) +
         " runs are not excluded";
}

std::string undecided_sentence(const std::string& label, const Verdict& verdict) {
  const std::uint64_t runs = complete_runs(verdict);
  std::string words = label + " is undecided: " + std::to_string(runs) +
                      (runs == 1 ? " run does" : " runs do") + " not show whether it is " +
                      within_words(verdict);
  if (runs < kFewestRunsOfTraces) {
    return words + "; fewer than " + std::to_string(kFewestRunsOfTraces) +
           " runs are judged as if errors never changed within a run";
  }
  if (!verdict.more_runs) return words;
  return words + "; about " + std::to_string(*verdict.more_runs) + " more would";
}

std::string sentence_of(const std::string& label, const Verdict& verdict) {
  switch (verdict.answer) {
    case Answer::consistent:
      return consistent_sentence(label, verdict);
    case Answer::optimistic:
      return label + " is optimistic (overconfident): " + squared_errors(verdict);
    case Answer::conservative:
      return label + " is conservative: " + squared_errors(verdict);
    case Answer::inconsistent:
      return label + " is inconsistent: " + inconsistent_words(verdict);
    case Answer::undecided:
      return undecided_sentence(label, verdict);
    case Answer::untested:
      break;
  }
  const std::uint64_t runs = complete_runs(verdict);
  if (runs > 0 && runs < kFewestJudgedRuns) {
    return label + " is not tested: fewer than " + std::to_string(kFewestJudgedRuns) +
           " runs are complete";
  }
  return label + " is not tested: no complete run has a covariance that can be judged";
}

}  // namespace

std::string in_words(const Verdict& verdict) {
  const std::string exceptions = exceptions_of(verdict);
  if (exceptions.empty()) return answer_words(verdict);
  const bool is_good = verdict.answer == Answer::consistent;
  return answer_words(verdict) + (is_good ? " in what can be judged" : "") + " (" + exceptions +
         ")";
}

std::string sentence(const std::string& label, const Verdict& verdict) {
  const std::string exceptions = exceptions_of(verdict);
  return sentence_of(label, verdict) + (exceptions.empty() ? "." : " (" + exceptions + ").");
}

}  // namespace montecarta::analysis
