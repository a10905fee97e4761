// SPDX-License-Identifier: BSD-3-Clause
// Promises of the verdict on one drive (300 s, a fix a second) and on several drives (60 to 300
// fixes). `MONTECARTA_STUDIES=4000 build/analysis_tests --gtest_filter='*SlowDrive*:*Several*'`
// prints the whole tables; without the variable it is a few lines.
#include "analysis/statistics/correlated_average.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <tuple>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kFixes = 300;
constexpr double kInfiniteMemory = 1e12;  // [s]

/// The correlation over a drive of errors of variance 1.
enum class Shape {
  one_memory,     ///< all components forget by exp(-t / memory)
  two_memories,   ///< half of the variance does, half is gone within a second
  swings,         ///< and turn once in twice the memory
  one_slow_only,  ///< the first component does, the others forget within a second
};

const char* name_of(Shape shape) {
  constexpr const char* names[] = {"one memory", "two memories", "swings", "one slow"};
  return names[static_cast<std::size_t>(shape)];
}

void add_forgetting(RngStream& draw, double memory, double sigma, std::vector<double>& series) {
  const double keep = std::exp(-1.0 / memory), rest = std::sqrt(1.0 - keep * keep);
  double state = draw.normal();
  for (double& value : series) {
    value += sigma * state;
    state = keep * state + rest * draw.normal();
  }
}

void add_swings(RngStream& draw, double memory, std::vector<double>& series) {
  const double keep = std::exp(-1.0 / memory), rest = std::sqrt(1.0 - keep * keep);
  double a = draw.normal(), b = draw.normal();
  for (std::size_t t = 0; t < series.size(); ++t) {
    const double turn = kPi * static_cast<double>(t) / memory;
    series[t] += a * std::cos(turn) + b * std::sin(turn);
    a = keep * a + rest * draw.normal();
    b = keep * b + rest * draw.normal();
  }
}

VectorSeries draw_errors(Shape shape, std::size_t dimension, double memory, double ratio,
                         std::uint64_t drive) {
  RngStream draw({.seed = drive, .purpose = Draw::test});
  VectorSeries errors(dimension, std::vector<double>(kFixes));
  for (std::size_t c = 0; c < dimension; ++c) {
    const bool is_slow = shape != Shape::one_slow_only || c == 0;
    const double half = std::sqrt(0.5);
    switch (shape) {
      case Shape::one_memory:
      case Shape::one_slow_only:
        add_forgetting(draw, is_slow ? memory : 0.3, 1.0, errors[c]);
        break;
      case Shape::two_memories:
        add_forgetting(draw, memory, half, errors[c]);
        add_forgetting(draw, 0.3, half, errors[c]);
        break;
      case Shape::swings:
        add_swings(draw, memory, errors[c]);
        break;
    }
    for (double& error : errors[c]) error *= std::sqrt(ratio);
  }
  return errors;
}

/// Shares of drives.
struct DriveRates {
  double above = 0.0, below = 0.0;  ///< the interval is above or below 1
  double naive = 0.0;               ///< the bounds of as many independent fixes are left
  double samples = 0.0;             ///< effective ones, mean
};

DriveRates drive_rates(Shape shape, std::size_t dimension, double memory, double ratio,
                       std::uint64_t drives) {
  const double one = 1.0 / static_cast<double>(drives);
  const Interval naive = nees_bounds(kFixes, dimension, 0.95);
  DriveRates rates;
  for (std::uint64_t drive = 0; drive < drives; ++drive) {
    const CorrelatedAverage found =
        correlated_average(draw_errors(shape, dimension, memory, ratio, drive), 0.95);
    rates.above += found.ratio.lower > 1.0 ? one : 0.0;
    rates.below += found.ratio.upper < 1.0 ? one : 0.0;
    const double nees = found.mean * static_cast<double>(dimension);
    rates.naive += nees < naive.lower || nees > naive.upper ? one : 0.0;
    rates.samples += one * found.effective_samples;
  }
  return rates;
}

using ShapeAndComponents = std::tuple<Shape, std::size_t>;

class SlowDriveRates : public ::testing::TestWithParam<ShapeAndComponents> {};

TEST_P(SlowDriveRates, RejectAConsistentFilterInFivePercentOfDrivesAtMost) {
  const auto [shape, dimension] = GetParam();
  const std::uint64_t drives = studies_of_a_line(400);
  std::printf(
      "%s, %d components\nmemory [s]  rejected [%%]  above  below  by as many independent "
      "fixes  effective\n",
      name_of(shape), static_cast<int>(dimension));
  for (const double memory : {1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, kInfiniteMemory}) {
    const bool is_between = memory == 3.0 || memory == 30.0 || memory == 1000.0;
    if (is_between && !is_table_wanted()) continue;
    const DriveRates rates = drive_rates(shape, dimension, memory, 1.0, drives);
    std::printf("%10.3g  %11.2f  %5.2f  %5.2f  %27.2f  %9.1f\n", memory,
                100.0 * (rates.above + rates.below), 100.0 * rates.above, 100.0 * rates.below,
                100.0 * rates.naive, rates.samples);
    std::fflush(stdout);
    EXPECT_LT(rates.above + rates.below, 0.05 + share_errors(0.05, drives)) << memory;
    if (memory >= 10.0 && shape == Shape::one_memory) {
      EXPECT_GT(rates.naive, 0.3) << memory << ": the drives are not correlated";
    }
  }
}

std::vector<ShapeAndComponents> tested_shapes() {
  std::vector<ShapeAndComponents> all;
  for (const Shape shape :
       {Shape::one_memory, Shape::two_memories, Shape::swings, Shape::one_slow_only}) {
    for (const std::size_t dimension : {1U, 2U, 3U}) all.emplace_back(shape, dimension);
  }
  return tested_lines(std::move(all), [](const ShapeAndComponents& line) {
    return std::get<1>(line) == 3 || std::get<0>(line) == Shape::one_memory;
  });
}

INSTANTIATE_TEST_SUITE_P(OfShapesAndComponents, SlowDriveRates,
                         ::testing::ValuesIn(tested_shapes()));

class SlowDrivePower : public ::testing::TestWithParam<std::size_t> {};

// A drive is not silent either: a ratio far from 1 is found while errors forget within seconds.
TEST_P(SlowDrivePower, FindsWhatIsFarOff) {
  const std::size_t dimension = GetParam();
  const std::uint64_t drives = studies_of_a_line(400) / 4;
  std::printf("%d components\nmemory [s]  ratio  above [%%]  below\n", static_cast<int>(dimension));
  for (const double memory : {1.0, 10.0, 100.0}) {
    for (const double ratio : {0.1, 0.25, 0.5, 1.5, 2.0, 4.0, 10.0}) {
      const DriveRates rates = drive_rates(Shape::one_memory, dimension, memory, ratio, drives);
      std::printf("%10.3g  %5.3g  %9.1f  %5.1f\n", memory, ratio, 100.0 * rates.above,
                  100.0 * rates.below);
      std::fflush(stdout);
      EXPECT_LT(ratio > 1.0 ? rates.below : rates.above, 0.025 + share_errors(0.025, drives))
          << memory << " " << ratio;
      const bool is_found = memory <= 1.0 && (ratio >= 1.5 || (ratio <= 0.1 && dimension > 1));
      if (!is_found) continue;
      EXPECT_GT(ratio > 1.0 ? rates.above : rates.below, 0.9) << ratio;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfComponents, SlowDrivePower, ::testing::Values(1U, 2U, 3U));

/// Errors of variance `ratio` of a drive, half of which forget by exp(-t / memory), half within a
/// fix; `slow` 1: all forget so slowly.
VectorSeries draw_own_drive(std::size_t dimension, double memory, double slow, double ratio,
                            std::uint64_t study, std::uint64_t drive) {
  RngStream draw({.seed = study, .run = drive, .purpose = Draw::test});
  const std::size_t fixes = 60 + 60 * (drive % 5);  // lengths of their own
  const double keep = std::exp(-1.0 / memory), rest = std::sqrt(1.0 - keep * keep);
  VectorSeries errors(dimension, std::vector<double>(fixes));
  for (auto& component : errors) {
    double state = draw.normal();
    for (double& value : component) {
      value = std::sqrt(ratio) * (std::sqrt(slow) * state + std::sqrt(1.0 - slow) * draw.normal());
      state = keep * state + rest * draw.normal();
    }
  }
  return errors;
}

struct RatesOfDrives {
  double above = 0.0, below = 0.0, width = 0.0;
};

RatesOfDrives rates_of_drives(std::size_t drives, std::size_t dimension, double memory, double slow,
                              double ratio, std::uint64_t studies) {
  RatesOfDrives rates;
  const double one = 1.0 / static_cast<double>(studies);
  for (std::uint64_t study = 0; study < studies; ++study) {
    std::vector<VectorSeries> all;
    for (std::size_t drive = 0; drive < drives; ++drive)
      all.push_back(draw_own_drive(dimension, memory, slow, ratio, study, drive));
    const CorrelatedAverage found = correlated_average(all, 0.95);
    rates.above += found.ratio.lower > 1.0 ? one : 0.0;
    rates.below += found.ratio.upper < 1.0 ? one : 0.0;
    rates.width += one * std::log(found.ratio.upper / found.ratio.lower);
  }
  return rates;
}

/// Number of drives and of components, and the slow part of the errors.
using DrivesLine = std::tuple<std::size_t, std::size_t, double>;

class SlowSeveralDrives : public ::testing::TestWithParam<DrivesLine> {};

TEST_P(SlowSeveralDrives, RejectAConsistentFilterInFivePercentOfStudiesAtMost) {
  const auto [drives, dimension, slow] = GetParam();
  const std::uint64_t studies = studies_of_a_line(200);
  std::printf("%d drives, %d components, slow part %.1f\nmemory  above [%%]  below  upper/lower\n",
              static_cast<int>(drives), static_cast<int>(dimension), slow);
  for (const double memory : {1.0, 10.0, 100.0, 1e12}) {
    const RatesOfDrives rates = rates_of_drives(drives, dimension, memory, slow, 1.0, studies);
    std::printf("%6.3g  %9.2f  %5.2f  %11.3g\n", memory, 100.0 * rates.above, 100.0 * rates.below,
                std::exp(rates.width));
    std::fflush(stdout);
    EXPECT_LT(rates.above + rates.below, 0.05 + share_errors(0.05, studies)) << memory;
  }
}

std::vector<DrivesLine> tested_drives() {
  std::vector<DrivesLine> all;
  for (const std::size_t drives : {2U, 5U, 20U}) {
    for (const std::size_t dimension : {1U, 3U}) {
      for (const double slow : {0.5, 1.0}) all.emplace_back(drives, dimension, slow);
    }
  }
  return tested_lines(std::move(all), [](const DrivesLine& line) {
    return std::get<0>(line) < 20 && std::get<1>(line) == 3 && std::get<2>(line) == 1.0;
  });
}

INSTANTIATE_TEST_SUITE_P(OfDrivesAndComponents, SlowSeveralDrives,
                         ::testing::ValuesIn(tested_drives()));

// Errors that last for a whole drive make one drive silent, and twenty not.
TEST(SlowSeveralDrivesPower, ManyDrivesFindWhatOneCannot) {
  const RatesOfDrives one = rates_of_drives(1, 3, 1e12, 1.0, 3.0, 60);
  const RatesOfDrives many = rates_of_drives(20, 3, 1e12, 1.0, 3.0, 60);
  EXPECT_LT(one.above, 0.5);
  EXPECT_GT(many.above, 0.95);
}

}  // namespace
}  // namespace montecarta::analysis
