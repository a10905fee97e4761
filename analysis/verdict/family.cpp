// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/family.hpp"

#include "analysis/output/number_text.hpp"
#include "analysis/statistics/paired_tests.hpp"

#include <algorithm>

namespace montecarta::analysis {

std::string name_of(Family family) {
  switch (family) {
    case Family::size:
      return "size";
    case Family::component:
      return "component";
    case Family::stretch:
      return "stretch";
    case Family::scan:
      return "scan";
    case Family::bias:
      return "bias";
    case Family::correlation:
      return "correlation";
    case Family::between_runs:
      break;
  }
  return "between runs";
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

}  // namespace montecarta::analysis
