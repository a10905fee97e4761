// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/control_motion.hpp"

#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

// In the order of the enumerators.
const std::vector<std::string> kMotions{"linearised", "quadrature", "unbiased"};

Option motion_option(const char* fallback) {
  return choice_option(
      "motion", fallback, kMotions,
      "how noise of the control reaches the pose: by derivatives, averaged, or as the noise "
      "of a measurement of the true control");
}

}  // namespace

Option linearised_motion_option() { return motion_option("linearised"); }

Option fitting_motion_option() {
  Option option = motion_option("quadrature");
  option.fallback_if_measured = "unbiased";
  return option;
}

Motion motion_of(const FilterOptions& options) {
  return chosen<Motion>(options.choice("motion"), kMotions);
}

void advance(MotionIncrement& increment, const Control& control, double duration,
             const Belief& belief, Motion motion) {
  switch (motion) {
    case Motion::linearised:
      increment.advance(control, duration, belief);
      break;
    case Motion::quadrature:
      increment = moved_by_quadrature(increment, control, duration, belief);
      break;
    case Motion::unbiased:
      increment = moved_by_unbiased_controls(increment, control, duration, belief);
      break;
  }
}

}  // namespace montecarta::filters
