// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/provenance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace montecarta::engine {
namespace {

TEST(Provenance, KnowsBuildAndMachine) {
  const TextPairs pairs = collect_provenance();
  const std::map<std::string, std::string> facts(pairs.begin(), pairs.end());
  for (const auto& [name, value] : facts) EXPECT_FALSE(value.empty()) << name;
  EXPECT_THAT(facts.at("date"), ::testing::MatchesRegex("20..-..-..T..:..:..Z"));
  EXPECT_THAT(facts.at("git"), ::testing::MatchesRegex("unknown|[0-9a-f]{40}(-dirty)?"));
  EXPECT_THAT(facts.at("flags"), ::testing::HasSubstr("-ffp-contract=off"));
  EXPECT_THAT(facts.at("version"), ::testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
}

}  // namespace
}  // namespace montecarta::engine
