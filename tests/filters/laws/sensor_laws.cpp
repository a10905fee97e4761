// SPDX-License-Identifier: BSD-3-Clause
// The laws of every filter with every sensor that it takes, on some vehicles.
#include "filters/factory.hpp"
#include "tests/filters/consistent_anees.hpp"
#include "tests/filters/laws/filters_held_to_laws.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/some_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr std::size_t kParticles = 30, kManyParticles = 100;

struct Offered {
  FilterKind kind;
  SomeSensor sensor;

  std::string name() const { return kind.name + "_" + sensor.name; }
};
void PrintTo(const Offered& offered, std::ostream* out) { *out << offered.name(); }

/// Each sensor but the default at the pose, of which other tests are full, with each filter for
/// which `condition(kind)` holds.
template <class Condition>
std::vector<Offered> offered_to(const Condition& condition) {
  std::vector<Offered> all;
  for (const FilterKind& kind : filters_held_to_laws(condition)) {
    for (const SomeSensor& sensor : some_sensors()) {
      if (!takes(kind, sensor.sensor) || sensor.name == RangeBearingSensor::kName) continue;
      all.push_back({kind, sensor});
    }
  }
  return all;
}

/// An easy world: small noise, many landmarks.
Belief easy(const SomeVehicle& vehicle, const Sensor& sensor) {
  Belief noise{.vehicle = vehicle.vehicle, .sigma_range = 0.02, .sigma_bearing = 0.003};
  for (double& sigma : noise.control.sigma) sigma = 0.02;
  noise.sigma_forward = 0.02;
  noise.sigma_left = 0.03;
  noise.sensor = sensor;
  return noise;
}

class EveryFilterAndSensor : public testing::TestWithParam<Offered> {
 protected:
  const FilterKind& kind() const { return GetParam().kind; }
  /// Calls law(settings) with some vehicles.
  template <class Law>
  void on_vehicles(std::uint64_t seed, std::size_t scans, const Law& law) const {
    for (const SomeVehicle& vehicle : some_vehicles()) {
      if (vehicle.name == "rear_wheel" || vehicle.name.ends_with("euler")) continue;
      SCOPED_TRACE(vehicle.name);
      law(SmallWorldSettings{.seed = seed,
                             .landmarks = 25,
                             .scans = scans,
                             .noise = easy(vehicle, GetParam().sensor.sensor),
                             .controls = {vehicle.typical}});
    }
  }
  std::unique_ptr<SlamFilter> make(const SmallWorldSettings& settings,
                                   std::size_t n = kParticles) const {
    return make_filter(kind(), settings, {{"particles", std::to_string(n)}});
  }
  void expect_map_near_the_truth(const SmallWorldSettings& settings) const;
};

TEST_P(EveryFilterAndSensor, TurningTheWorldTurnsTheEstimate) {
  on_vehicles(1, 60, [&](const SmallWorldSettings& settings) {
    expect_turns_with_the_world(*make(settings), small_world(settings));
  });
}

TEST_P(EveryFilterAndSensor, GivesTheSameBitsAgain) {
  const std::size_t n = kind().reports.particles ? kParticles : 0;
  on_vehicles(2, 40, [&](const SmallWorldSettings& settings) {
    const SmallWorld world = small_world(settings);
    const auto filter = make(settings);
    EXPECT_TRUE(told(*filter, n, world) == told(*filter, n, world));
  });
}

void EveryFilterAndSensor::expect_map_near_the_truth(const SmallWorldSettings& settings) const {
  const SmallWorld world = small_world(settings);
  const auto filter = make(settings);
  double nis = 0.0, dof = 0.0;
  std::size_t fullest = 0;
  drive_through(*filter, world, Pose(), [&](std::size_t scan) {
    nis += filter->report().nis;
    dof += filter->report().nis_dof;
    // Once all landmarks in view are held, every detection counts by its components.
    const std::size_t components = components_of(GetParam().sensor.sensor).size();
    const std::size_t most = components * world.drive.scan(scan).size();
    EXPECT_LE(filter->report().nis_dof, most);
    EXPECT_EQ(filter->report().nis_dof % components, 0U);
    fullest = std::max(fullest, filter->report().nis_dof == most ? most : 0);
  });
  EXPECT_GT(fullest, 0U);
  std::vector<std::optional<LandmarkEstimate>> map(25);
  filter->map(map);
  int held = 0, astray = 0;
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (!map[k]) continue;
    ++held;
    if ((map[k]->mean - world.itinerary.landmarks[k]).norm() > 1.5) ++astray;
  }
  EXPECT_GE(held, 8);
  EXPECT_LE(astray, kind().reports.particles ? held / 5 : 0);  // paths of few particles are coarse
  EXPECT_NEAR(filter->report().map_size, held, 1e-9);
  EXPECT_GT(dof, 300.0);
  if (kind().reports.particles) return;
  EXPECT_NEAR(nis / dof, 1.0, 5.0 * std::sqrt(2.0 / dof));
}

class EveryMapAndSensor : public EveryFilterAndSensor {};
class EveryJointFilterAndSensor : public EveryFilterAndSensor {};
class EveryParticleFilterAndSensor : public EveryFilterAndSensor {};

TEST_P(EveryMapAndSensor, BuildsAMapNearTheTruthAndCountsItsInnovations) {
  on_vehicles(3, 120, [&](const auto& settings) { expect_map_near_the_truth(settings); });
}

/// The law is of joint filters, since particles run out of diversity. The band has five standard
/// errors.
TEST_P(EveryJointFilterAndSensor, SlowIsConsistentOnAnEasyWorld) {
  constexpr std::uint64_t kRuns = 60;
  on_vehicles(100, 60, [&](const SmallWorldSettings& settings) {
    EXPECT_TRUE(is_consistent(final_errors(*make(settings), settings, kRuns).anees, kRuns));
  });
}

TEST_P(EveryParticleFilterAndSensor, SlowErrsByLessThanTwiceTheKalmanFilterOnAnEasyWorld) {
  constexpr std::uint64_t kRuns = 60;
  const auto kalman = std::ranges::find(filter_kinds(), "ekf_slam", &FilterKind::name);
  on_vehicles(100, 60, [&](const SmallWorldSettings& settings) {
    const double expected = final_errors(*make_filter(*kalman, settings), settings, kRuns).squared;
    const double found = final_errors(*make(settings, kManyParticles), settings, kRuns).squared;
    EXPECT_LT(found, 4.0 * expected);
  });
}

bool is_any(const FilterKind& /*kind*/) { return true; }
bool has_map(const FilterKind& kind) { return kind.reports.map; }
bool has_particles(const FilterKind& kind) { return kind.reports.particles; }

/// Name of a test by what is offered.
struct OfferedName {
  std::string operator()(const testing::TestParamInfo<Offered>& instance) const {
    return instance.param.name();
  }
};

INSTANTIATE_TEST_SUITE_P(All, EveryFilterAndSensor, testing::ValuesIn(offered_to(is_any)),
                         OfferedName());
INSTANTIATE_TEST_SUITE_P(All, EveryMapAndSensor, testing::ValuesIn(offered_to(has_map)),
                         OfferedName());
INSTANTIATE_TEST_SUITE_P(All, EveryJointFilterAndSensor,
                         testing::ValuesIn(offered_to(std::not_fn(has_particles))), OfferedName());
INSTANTIATE_TEST_SUITE_P(All, EveryParticleFilterAndSensor,
                         testing::ValuesIn(offered_to(has_particles)), OfferedName());
// Where one filter alone is held to these laws, none may be of such a kind.
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(EveryMapAndSensor);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(EveryJointFilterAndSensor);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(EveryParticleFilterAndSensor);

}  // namespace
}  // namespace montecarta::filters
