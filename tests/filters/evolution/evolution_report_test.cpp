// SPDX-License-Identifier: BSD-3-Clause
// The columns in which filters report what their evolution changed.
#include "filters/evolution/evolution_report.hpp"

#include "filters/factory.hpp"
#include "tests/filters/small_world.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

using testing::Each;
using testing::ElementsAre;

TEST(EvolutionReport, AddsUpEvaluationsAndAveragesTheRestOverThePopulations) {
  EvolutionReport report;
  report.begin_scan();
  report.add({.members = 10, .generations = 3.0, .gain = 1.0, .displacement = 0.5});
  report.add({.members = 7, .generations = 0.0, .gain = 2.0, .displacement = 0.0});
  report.end_scan();
  EXPECT_THAT(report.values(), ElementsAre(47.0, 1.5, 1.5, 0.25));
  report.begin_scan();
  report.end_scan();
  EXPECT_THAT(report.values(), Each(0.0));
}

TEST(EvolutionReport, DeclaresAsManyColumnsAsItHasValues) {
  EXPECT_EQ(EvolutionReport::columns().size(), EvolutionReport().values().size());
}

FilterKind evolving_kind(const std::string& name) {
  return *std::ranges::find(filter_kinds(), name, &FilterKind::name);
}

/// Evaluations, generations, gain and displacement.
using Effects = std::vector<double>;

/// {scan} What a filter reports, with landmarks to match from the second scan on.
std::vector<Effects> effects_of(const std::string& filter, OptionTexts options) {
  options.emplace("particles", "13");
  const SmallWorldSettings settings{.seed = 4, .scans = 12};
  const auto made = make_filter(evolving_kind(filter), settings, options);
  std::vector<Effects> effects;
  drive_through(*made, small_world(settings), Pose(), [&](std::size_t /*scan*/) {
    const std::span<const double> own = made->report().own;
    effects.emplace_back(own.begin(), own.end());
  });
  return effects;
}

Effects last_effects(const std::string& filter, const OptionTexts& options) {
  return effects_of(filter, options).back();
}

/// Sums over all scans.
Effects total_effects(const std::string& filter, const OptionTexts& options) {
  Effects total(4);
  for (const Effects& one : effects_of(filter, options)) {
    for (std::size_t k = 0; k < total.size(); ++k) total[k] += one.at(k);
  }
  return total;
}

TEST(EvolutionReport, IsZeroAtAScanThatMatchesNoLandmark) {
  EXPECT_THAT(effects_of("de_srcd", {}).front(), ElementsAre(0.0, 0.0, 0.0, 0.0));
  EXPECT_THAT(effects_of("ampf_de", {}).front(), ElementsAre(0.0, 0.0, 0.0, 0.0));
}

TEST(EvolutionReport, CountsThePopulationsOfAllParticles) {
  const Effects found = last_effects("de_srcd", {{"generations", "4"}, {"population", "9"}});
  EXPECT_EQ(found[1], 4.0);
  EXPECT_EQ(found[0], 13.0 * 9.0 * 5.0);
  const Effects total = total_effects("de_srcd", {{"generations", "12"}});
  EXPECT_GT(total[2], 0.0);
  EXPECT_GT(total[3], 0.0);
  EXPECT_LT(total[3], 12.0 * 3.0 * std::sqrt(3.0)) << "the bounds of the search";
}

TEST(EvolutionReport, OfACloudIsOfOnePopulation) {
  for (const char* mode : {"as_printed", "prior", "shared"}) {
    SCOPED_TRACE(mode);
    const Effects still = last_effects("de_srcd", {{"generations", "0"}, {"mode", mode}});
    EXPECT_THAT(still, ElementsAre(13.0, 0.0, 0.0, testing::Lt(1e-6)));
    const Effects found = last_effects("de_srcd", {{"generations", "2"}, {"mode", mode}});
    EXPECT_EQ(found[0], 13.0 * 3.0);
    const Effects total = total_effects("de_srcd", {{"generations", "40"}, {"mode", mode}});
    EXPECT_GT(total[2], 0.0);
    EXPECT_GT(total[3], 0.01);
  }
}

TEST(EvolutionReport, OfTheMapIsOfThePopulationsOfTheMatchedLandmarks) {
  const Effects found = last_effects("ampf_de", {{"generations", "2"}, {"population", "8"}});
  const double landmarks = found[0] / (8.0 * 3.0);
  EXPECT_GT(landmarks, 0.0);
  EXPECT_EQ(landmarks, std::round(landmarks));
  EXPECT_EQ(found[1], 2.0);
  EXPECT_GE(found[2], 0.0);
  EXPECT_TRUE(last_effects("ampf_de", {{"map_solver", "gauss_newton"}}).empty());
  EXPECT_FALSE(last_effects("marginal", {{"map_solver", "de"}}).empty());
}

TEST(EvolutionReport, GainsMoreWithMoreGenerations) {
  // The first scan with a match has the same poses and the same map for any number of generations.
  for (const char* filter : {"de_srcd", "ampf_de"}) {
    double before = -1.0;
    for (const char* generations : {"0", "1", "3", "10"}) {
      const auto effects = effects_of(filter, {{"generations", generations}});
      const auto first = std::ranges::find_if(effects, [](const auto& e) { return e[0] > 0.0; });
      ASSERT_NE(first, effects.end());
      EXPECT_GE((*first)[2], before) << filter << " with " << generations;
      before = (*first)[2];
    }
    EXPECT_GT(before, 0.0) << filter;
  }
}

}  // namespace
}  // namespace montecarta::filters
