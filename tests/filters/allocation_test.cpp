// SPDX-License-Identifier: BSD-3-Clause
#include "filters/factory.hpp"
#include "tests/doubles/allocation_count.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

std::unique_ptr<SlamFilter> make(
    const FilterKind& kind, Association association,
    const std::map<std::string, std::string, std::less<>>& options = {}) {
  return kind.make({.belief = {},
                    .association = {.kind = association},
                    .options = default_options(kind, options),
                    .landmarks = SmallWorldSettings().landmarks});
}

/// Where a recorder puts what a filter tells.
class Listener {
 public:
  explicit Listener(const FilterKind& kind) {
    if (!kind.reports.particles) return;
    for (const Parameter& option : kind.options) {
      if (option.key == "particles") log_weights_.resize(std::stoul(*option.fallback));
    }
    poses_.resize(3 * log_weights_.size()), ancestors_.resize(log_weights_.size());
  }
  void listen(const SlamFilter& filter) {
    filter.estimate();
    filter.particles({poses_, log_weights_, ancestors_});
    filter.map(map_);
  }

 private:
  std::vector<double> poses_, log_weights_;
  std::vector<std::uint32_t> ancestors_;
  std::vector<std::optional<LandmarkEstimate>> map_{SmallWorldSettings().landmarks};
};

// The first touch of memory costs more than all the arithmetic of a step.
TEST(Allocation, NoFilterAllocatesInASecondRun) {
  const SmallWorld world = small_world({.scans = 60});
  for (const FilterKind& kind : filter_kinds()) {
    if (kind.name.starts_with("plain_")) continue;  // written to be read, not to be fast
    for (const auto association : {Association::known, Association::nearest}) {
      const auto filter = make(kind, association);
      Listener listener(kind);
      const auto after_scan = [&](std::size_t) { listener.listen(*filter); };
      drive_through(*filter, world, Pose(), after_scan);
      const std::size_t before = n_allocations;
      drive_through(*filter, world, Pose(), after_scan);
      EXPECT_EQ(n_allocations, before) << kind.name;
    }
  }
}

/// Of a filter of which not every way is the one that is usual.
void expect_no_allocation(const char* name, const char* option, const char* value) {
  const SmallWorld world = small_world({.scans = 60});
  const auto kind = std::ranges::find(filter_kinds(), name, &FilterKind::name);
  const auto filter = make(*kind, Association::known, {{option, value}});
  drive_through(*filter, world, Pose(), [](std::size_t) {});
  const std::size_t before = n_allocations;
  drive_through(*filter, world, Pose(), [](std::size_t) {});
  EXPECT_EQ(n_allocations, before) << value;
}

TEST(Allocation, EvolutionOfAPopulationOfParticlesAllocatesNothingInASecondRun) {
  for (const char* mode : {"as_printed", "prior", "shared"})
    expect_no_allocation("de_srcd", "mode", mode);
}

TEST(Allocation, DelayedInitialisationInParticlesAllocatesNothingInASecondRun) {
  for (const SensorKind& kind : {SensorKind(BearingSensor()), SensorKind(RangeSensor())}) {
    SmallWorldSettings settings{.scans = 80};
    settings.noise.sensor.kind = kind;
    const SmallWorld world = small_world(settings);
    for (const char* name : {"fastslam1", "fastslam2", "ufastslam"}) {
      const auto filter = std::ranges::find(filter_kinds(), name, &FilterKind::name);
      const auto made = filter->make({.belief = settings.noise,
                                      .association = {},
                                      .options = default_options(*filter),
                                      .landmarks = settings.landmarks});
      drive_through(*made, world, Pose(), [](std::size_t) {});
      EXPECT_GT(made->report().map_size, 1.0);
      const std::size_t before = n_allocations;
      drive_through(*made, world, Pose(), [](std::size_t) {});
      EXPECT_EQ(n_allocations, before) << name;
    }
  }
}

}  // namespace
}  // namespace montecarta::filters
