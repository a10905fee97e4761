// SPDX-License-Identifier: BSD-3-Clause
// Landmarks in a form of their own: the family takes any that gaussian_of() gives as a Gaussian.
#include "filters/fastslam/motion_sampling.hpp"
#include "filters/fastslam/sigma_filters.hpp"
#include "tests/filters/fastslam/filter_comparison.hpp"
#include "tests/filters/some_models.hpp"

namespace montecarta::filters {
namespace {

class FastSlams : public testing::TestWithParam<Variant> {};

TEST_P(FastSlams, EqualsThePlainFilter) {
  const SmallWorldSettings settings;
  const auto lanes = make_production(GetParam(), settings);
  const auto plain = make_plain(GetParam(), settings);
  expect_same_run(*lanes, *plain, small_world(settings), 1e-8);
}

TEST_P(FastSlams, EqualsThePlainFilterInAKnownMap) {
  const SmallWorldSettings settings;
  const FilterSetup setup = in_known_map(setup_of(GetParam(), settings));
  for (const double landmark : {0.0, 0.1}) {
    SCOPED_TRACE(landmark);
    const auto lanes = kind_of(GetParam()).make(setup);
    const auto plain = kind_of({"plain_" + GetParam().filter}).make(setup);
    const SmallWorld world = in_known_map(small_world(settings),
                                          {.position = 0.2, .heading = 0.05, .landmark = landmark});
    expect_same_run(*lanes, *plain, world, 1e-8);
  }
}

/// Removes the detections of a scan, so that its fix comes alone.
void leave_alone(std::size_t scan, Drive& drive) {
  const std::uint32_t first = drive.scan_begin[scan], next = drive.scan_begin[scan + 1];
  drive.detections.erase(drive.detections.begin() + first, drive.detections.begin() + next);
  for (std::size_t s = scan + 1; s < drive.scan_begin.size(); ++s)
    drive.scan_begin[s] -= next - first;
}

TEST_P(FastSlams, EqualsThePlainFilterWithFixes) {
  SmallWorldSettings settings;
  settings.noise.sigma_fix = 0.2;
  const auto lanes = make_production(GetParam(), settings);
  const auto plain = make_plain(GetParam(), settings);
  SmallWorld world = with_fixes(small_world(settings), settings.noise, 2);
  leave_alone(3, world.drive);
  expect_same_run(*lanes, *plain, world, 1e-8);
}

TEST_P(FastSlams, EqualsThePlainFilterWithNoiseOfTheStep) {
  for (const IncrementNoise& increment : some_increments()) {
    SmallWorldSettings settings{.scans = 20};
    settings.noise.control.increment = increment;
    const auto lanes = make_production(GetParam(), settings);
    const auto plain = make_plain(GetParam(), settings);
    expect_same_run(*lanes, *plain, small_world(settings), 1e-8);
  }
}

TEST_P(FastSlams, EstimatesBetweenScansAsThePlainFilterDoes) {
  const SmallWorldSettings settings{.scans = 12};
  const auto lanes = make_production(GetParam(), settings);
  const auto plain = make_plain(GetParam(), settings);
  expect_same_steps(*lanes, *plain, small_world(settings), 1e-9);
}

using enum Association;

INSTANTIATE_TEST_SUITE_P(FastSlam, FastSlams,
                         testing::Values(Variant{"fastslam1"}, Variant{"fastslam2"},
                                         Variant{"fastslam2", "ratio"},
                                         Variant{"fastslam2", "batch"},
                                         Variant{"fastslam1", "closed", nearest},
                                         Variant{"fastslam2", "closed", nearest},
                                         Variant{"fastslam2", "batch", nearest, 40},
                                         Variant{"fastslam2", "ratio", nearest, 8},
                                         Variant{"fastslam2", "closed", known, 1},
                                         Variant{"fastslam1", "closed", known, 9}),
                         testing::PrintToStringParamName());

INSTANTIATE_TEST_SUITE_P(
    UFastSlam, FastSlams,
    testing::Values(
        Variant{"ufastslam"}, Variant{"ufastslam", "ratio"},
        Variant{"ufastslam", "closed", nearest},
        Variant{"ufastslam", "closed", known, 9, {{"map_uncertainty", "off"}}},
        Variant{"ufastslam", "ratio", nearest, 8, {{"map_uncertainty", "off"}}},
        Variant{
            "ufastslam", "closed", known, 1, {{"alpha", "0.5"}, {"beta", "0"}, {"kappa", "1"}}}),
    testing::PrintToStringParamName());

INSTANTIATE_TEST_SUITE_P(
    Srcd, FastSlams,
    testing::Values(Variant{"srcd"}, Variant{"srcd", "ratio"}, Variant{"srcd", "closed", nearest},
                    Variant{"srcd", "closed", known, 1, {{"map_uncertainty", "off"}}},
                    Variant{"srcd", "closed", known, 9, {{"interval", "1.3"}}},
                    Variant{"srcd_aided"}, Variant{"srcd_pf"},
                    Variant{"srcd_aided", "ratio", nearest, 8},
                    Variant{"srcd_pf", "ratio", nearest, 9, {{"map_uncertainty", "off"}}}),
    testing::PrintToStringParamName());

/// The form has units of two metres, a power of two, so that no bit is lost.
template <class Real>
struct InTwoMetres {
  BasicPoint<Real> mean{};
  Symmetric2<Real> covariance{};
};

template <class Real>
InTwoMetres<Real> in_two_metres(const LandmarkGaussian<Real>& landmark) {
  const auto& [mean, covariance] = landmark;
  return {{0.5 * mean.x, 0.5 * mean.y}, Real(0.25) * covariance};
}
template <class Real>
LandmarkGaussian<Real> gaussian_of(const InTwoMetres<Real>& landmark) {
  const auto& [mean, covariance] = landmark;
  return {{2.0 * mean.x, 2.0 * mean.y}, Real(4.0) * covariance};
}

struct LinearisedInTwoMetres {
  template <class Real, class Mask, class Weighed>
  Innovation<Real> update(InTwoMetres<Real>& landmark, const BasicPose<Real>& pose,
                          const Measurement<Real>& seen, const SensorNoise& noise,
                          const Mask& matched, Weighed& evidence) const {
    LandmarkGaussian<Real> in_map = gaussian_of(landmark);
    Innovation<Real> v = Linearised().update(in_map, pose, seen, noise, matched, evidence);
    landmark = in_two_metres(in_map);
    return v;
  }
  template <class Real>
  InTwoMetres<Real> initialise(const BasicPose<Real>& pose, const Measurement<Real>& seen,
                               const SensorNoise& noise) const {
    return in_two_metres(Linearised().initialise(pose, seen, noise));
  }
};

class LandmarkForms : public testing::TestWithParam<Variant> {};

TEST_P(LandmarkForms, AreUpdatedAssociatedResampledAndReported) {
  const SmallWorldSettings settings;
  const SmallWorld world = small_world(settings);
  const auto plain = make_production(GetParam(), settings);
  const auto other =
      make_refined<Lanes>(setup_of(GetParam(), settings), Linearised(), LinearisedInTwoMetres());
  expect_same_run(*plain, *other, world, 1e-300);
  std::vector<std::optional<LandmarkEstimate>> expected(settings.landmarks), map(expected);
  plain->map(expected), other->map(map);
  for (std::size_t j = 0; j < map.size(); ++j) {
    ASSERT_EQ(map[j].has_value(), expected[j].has_value());
    if (!map[j]) continue;
    EXPECT_EQ(map[j]->mean, expected[j]->mean);
    EXPECT_EQ(map[j]->covariance, expected[j]->covariance);
  }
}

// A bearing would be taken for a range.
TEST(LandmarkForm, IsRefusedAnotherSensorThanRangeAndBearingAtThePose) {
  const SmallWorldSettings settings;
  for (const Sensor& sensor : {Sensor{.kind = BearingSensor()}, Sensor{.kind = RangeBearingSensor(),
                                                                .mounting = {.forward = 1.0}}}) {
    FilterSetup setup = setup_of(Variant{"fastslam2"}, settings);
    setup.belief.sensor = sensor;
    EXPECT_THROW(make_refined<Lanes>(setup, Linearised(), LinearisedInTwoMetres()),
                 std::logic_error);
  }
}

INSTANTIATE_TEST_SUITE_P(All, LandmarkForms,
                         testing::Values(Variant{"fastslam2"}, Variant{"fastslam2", "ratio"},
                                         Variant{"fastslam2", "batch"},
                                         Variant{"fastslam2", "closed", Association::nearest}),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace montecarta::filters
