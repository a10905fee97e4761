// SPDX-License-Identifier: BSD-3-Clause
// The laws of every filter with every sensor that it takes, on some vehicles.
#include "filters/factory.hpp"
#include "tests/filters/consistent_anees.hpp"
#include "tests/filters/laws/filters_held_to_laws.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/some_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr std::size_t kParticles = 30, kManyParticles = 100;

struct Offered {
  FilterKind kind;
  SomeSensor sensor;
  SomeVehicle vehicle;

  std::string name() const { return kind.name + "_" + sensor.name + "_" + vehicle.name; }
};
void PrintTo(const Offered& offered, std::ostream* out) { *out << offered.name(); }

bool takes(const FilterKind& kind, const Sensor& sensor) {
  if (kind.sensors.empty()) return true;
  return sensor.mounting.is_none() &&
         std::ranges::find(kind.sensors, name_of(sensor)) != kind.sensors.end();
}

/// Each sensor but the default at the pose, of which other tests are full.
std::vector<Offered> all_offered() {
  std::vector<Offered> all;
  for (const FilterKind& kind : filters_held_to_laws()) {
    for (const SomeSensor& sensor : some_sensors()) {
      if (!takes(kind, sensor.sensor) || sensor.name == RangeBearingSensor::kName) continue;
      for (const SomeVehicle& vehicle : some_vehicles()) {
        if (vehicle.name == "rear_wheel" || vehicle.name.ends_with("euler")) continue;
        all.push_back({kind, sensor, vehicle});
      }
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
  SmallWorldSettings settings(std::uint64_t seed, std::size_t scans) const {
    const SomeVehicle& vehicle = GetParam().vehicle;
    return {.seed = seed,
            .landmarks = 25,
            .scans = scans,
            .noise = easy(vehicle, GetParam().sensor.sensor),
            .controls = {vehicle.typical}};
  }
  std::unique_ptr<SlamFilter> make(std::size_t n = kParticles) const { return made(kind(), n); }
  std::unique_ptr<SlamFilter> made(const FilterKind& of, std::size_t n) const {
    return make_filter(of, settings(1, 1), {{"particles", std::to_string(n)}});
  }
};

TEST_P(EveryFilterAndSensor, TurningTheWorldTurnsTheEstimate) {
  expect_turns_with_the_world(*make(), small_world(settings(1, 60)));
}

TEST_P(EveryFilterAndSensor, GivesTheSameBitsAgain) {
  const SmallWorld world = small_world(settings(2, 40));
  const auto filter = make();
  const std::size_t n = kind().reports.particles ? kParticles : 0;
  EXPECT_TRUE(told(*filter, n, world) == told(*filter, n, world));
}

TEST_P(EveryFilterAndSensor, BuildsAMapNearTheTruthAndCountsItsInnovations) {
  if (!kind().reports.map) GTEST_SKIP() << "no map";
  const SmallWorld world = small_world(settings(3, 120));
  const auto filter = make();
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

/// The law is of joint filters, since particles run out of diversity. The band has five standard
/// errors.
TEST_P(EveryFilterAndSensor, SlowIsConsistentOnAnEasyWorld) {
  if (kind().reports.particles) GTEST_SKIP() << "no joint covariance";
  constexpr std::uint64_t kRuns = 60;
  EXPECT_TRUE(is_consistent(final_errors(*make(), settings(100, 60), kRuns).anees, kRuns));
}

TEST_P(EveryFilterAndSensor, SlowErrsByLessThanTwiceTheKalmanFilterOnAnEasyWorld) {
  if (!kind().reports.particles) GTEST_SKIP() << "is one, or has no map";
  constexpr std::uint64_t kRuns = 60;
  const auto kalman = std::ranges::find(filter_kinds(), "ekf_slam", &FilterKind::name);
  const double expected = final_errors(*made(*kalman, 0), settings(100, 60), kRuns).squared;
  EXPECT_LT(final_errors(*make(kManyParticles), settings(100, 60), kRuns).squared, 4.0 * expected);
}

INSTANTIATE_TEST_SUITE_P(All, EveryFilterAndSensor, testing::ValuesIn(all_offered()),
                         [](const auto& instance) { return instance.param.name(); });

}  // namespace
}  // namespace montecarta::filters
