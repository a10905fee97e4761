// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/increment_noise.hpp"

#include "engine/numbers/lanes.hpp"
#include "tests/filters/some_models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::models {
namespace {

const std::vector<BodyStep<double>>& some_steps() {
  static const std::vector<BodyStep<double>> all{
      {0.5, 0.1, 0.3}, {-0.5, 0.1, -0.2}, {0.2, -0.4, 2.0}, {0.1, 0.0, 0.0}, {0.0, 0.0, 0.4}};
  return all;
}

TEST(TurnedWay, IsTheStep) {
  for (const BodyStep<double>& step : some_steps()) {
    const auto turned = turned_way_of(step);
    EXPECT_LE(std::abs(turned.rot1), 0.5 * kPi);
    const BodyStep<double> again = step_of(turned);
    EXPECT_NEAR(again.forward, step.forward, 1e-15);
    EXPECT_NEAR(again.left, step.left, 1e-15);
    EXPECT_NEAR(again.turn, step.turn, 1e-15);
  }
}

TEST(TurnedWay, IsTheSameInEveryLane) {
  for (const BodyStep<double>& step : some_steps()) {
    const auto one = turned_way_of(step);
    const auto lanes = turned_way_of(BodyStep<engine::Lanes>{step.forward, step.left, step.turn});
    for (std::size_t lane = 0; lane < engine::kLanesOf<engine::Lanes>; ++lane) {
      EXPECT_NEAR(get(lanes.rot1, lane), one.rot1, 1e-14);
      EXPECT_NEAR(get(lanes.trans, lane), one.trans, 1e-14);
      EXPECT_NEAR(get(lanes.rot2, lane), one.rot2, 1e-14);
    }
  }
}

/// Thrun, Burgard, Fox: Probabilistic Robotics, table 5.6.
TEST(IncrementNoise, OfOdometryHasTheVariancesOfTheBook) {
  const IncrementNoise noise{.model = IncrementModel::odometry, .alpha = {0.1, 0.2, 0.3, 0.4}};
  const TurnedWay<double> turned{.rot1 = 0.2, .trans = 0.5, .rot2 = -0.3};
  const auto sigma = increment_deviations(noise, step_of(turned), 0.1);
  EXPECT_NEAR(sigma[0] * sigma[0], 0.1 * 0.04 + 0.2 * 0.25, 1e-15);
  EXPECT_NEAR(sigma[1] * sigma[1], 0.3 * 0.25 + 0.4 * (0.04 + 0.09), 1e-15);
  EXPECT_NEAR(sigma[2] * sigma[2], 0.1 * 0.09 + 0.2 * 0.25, 1e-15);
}

TEST(IncrementNoise, ThatIsAddedIsThatOfAWalkInTime) {
  const IncrementNoise noise{.model = IncrementModel::additive, .sigma = {0.1, 0.2, 0.3}};
  const auto sigma = increment_deviations(noise, {1.0, 2.0, 3.0}, 0.25);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_DOUBLE_EQ(sigma[k], 0.5 * noise.sigma[k]);
}

/// The columns are the derivatives of perturbed().
TEST(IncrementNoise, HasTheDerivativesOfItsDraws) {
  constexpr double kSmall = 1e-6;
  for (const IncrementNoise& noise : filters::some_increments()) {
    for (const BodyStep<double>& step : some_steps()) {
      const auto sigma = increment_deviations(noise, step, 0.1);
      const auto columns = increment_columns(noise, step, 0.1);
      for (std::size_t k = 0; k < 3; ++k) {
        std::array<double, 3> ahead{}, back{};
        ahead[k] = kSmall, back[k] = -kSmall;
        const auto more = perturbed(step, noise.model, sigma, ahead);
        const auto less = perturbed(step, noise.model, sigma, back);
        EXPECT_NEAR((more.forward - less.forward) / (2 * kSmall), columns[k].forward, 1e-9);
        EXPECT_NEAR((more.left - less.left) / (2 * kSmall), columns[k].left, 1e-9);
        EXPECT_NEAR((more.turn - less.turn) / (2 * kSmall), columns[k].turn, 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace montecarta::models
