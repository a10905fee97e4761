// SPDX-License-Identifier: BSD-3-Clause
#include "filters/factory.hpp"
#include "tests/doubles/allocation_count.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

/// Buffers for the results of a filter, as a recorder has them.
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
      const auto filter = make_filter(kind, {}, {}, association);
      Listener listener(kind);
      const auto after_scan = [&](std::size_t) { listener.listen(*filter); };
      drive_through(*filter, world, Pose(), after_scan);
      const std::size_t before = n_allocations;
      drive_through(*filter, world, Pose(), after_scan);
      EXPECT_EQ(n_allocations, before) << kind.name;
    }
  }
}

/// Runs a filter with one option that is not the default.
void expect_no_allocation(const char* name, const char* option, const char* value) {
  const SmallWorld world = small_world({.scans = 60});
  const auto kind = std::ranges::find(filter_kinds(), name, &FilterKind::name);
  const auto filter = make_filter(*kind, {}, {{option, value}});
  drive_through(*filter, world);
  const std::size_t before = n_allocations;
  drive_through(*filter, world);
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
      const auto made = make_filter(*filter, settings);
      drive_through(*made, world);
      EXPECT_GT(made->report().map_size, 1.0);
      const std::size_t before = n_allocations;
      drive_through(*made, world);
      EXPECT_EQ(n_allocations, before) << name;
    }
  }
}

}  // namespace
}  // namespace montecarta::filters
