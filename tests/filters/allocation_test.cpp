// SPDX-License-Identifier: BSD-3-Clause
#include "filters/factory.hpp"
#include "tests/doubles/allocation_count.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace montecarta {
namespace {

std::unique_ptr<SlamFilter> make(const FilterKind& kind, Association association) {
  std::map<std::string, std::string, std::less<>> values;
  for (const FilterOption& option : kind.options) values[option.name] = option.fallback;
  return kind.make({.belief = {},
                    .association = {.kind = association},
                    .options = FilterOptions(values),
                    .landmarks = SmallWorldSettings().landmarks});
}

// The first touch of memory costs more than all the arithmetic of a step.
TEST(Allocation, NoFilterAllocatesInASecondRun) {
  const SmallWorld world = small_world({.scans = 60});
  for (const FilterKind& kind : filter_kinds()) {
    for (const auto association : {Association::known, Association::nearest}) {
      const auto filter = make(kind, association);
      drive_through(*filter, world, Pose(), [](std::size_t) {});
      const std::size_t before = n_allocations;
      drive_through(*filter, world, Pose(), [&](std::size_t) { filter->estimate(); });
      EXPECT_EQ(n_allocations, before) << kind.name;
    }
  }
}

}  // namespace
}  // namespace montecarta
