// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/family.hpp"

#include "analysis/output/number_text.hpp"
#include "analysis/statistics/paired_tests.hpp"

#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {

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

double spent(double alpha, double information) {
  if (!(information > 0.0)) return 0.0;
  const boost::math::normal normal;
  const double z = boost::math::quantile(boost::math::complement(normal, 0.5 * alpha));
  return 2.0 * boost::math::cdf(boost::math::complement(normal, z / std::sqrt(information)));
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

}  // namespace montecarta::analysis
