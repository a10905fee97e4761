// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "experiments/commands/commands.hpp"

#include <cstdio>
#include <iostream>

namespace montecarta::experiments {

int bounds_command(const Arguments& arguments) {
  const Interval interval = nees_bounds(
      arguments.count("runs", 1, 1'000'000'000).value(), arguments.count("dim", 1, 1000).value(),
      arguments.number("level", 1e-9, 1.0 - 1e-9).value_or(kUsualLevel));
  char text[64];
  std::snprintf(text, sizeof text, "[%.6f, %.6f]\n", interval.lower, interval.upper);
  std::cout << text;
  return kDone;
}

}  // namespace montecarta::experiments
