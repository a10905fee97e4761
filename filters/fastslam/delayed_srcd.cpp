// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/delayed.hpp"

namespace montecarta {

FilterKind delayed_srcd_kind() {
  std::vector<FilterOption> options = delayed_options();
  for (FilterOption& option : central_difference_options()) options.push_back(std::move(option));
  return {.name = "delayed_srcd",
          .long_name = "SRCD-FastSLAM with delayed draws",
          .source = "SPEC 10; SPEC 24, last lines",
          .has_particles = true,
          .has_mixture = true,
          .options = std::move(options),
          .make = [](const FilterSetup& setup) {
            return are_anchored(setup.options)
                       ? make_delaying<Lanes>(setup, delayed_srcd_points(setup), Anchored())
                       : make_delayed_srcd<Lanes>(setup);
          }};
}

}  // namespace montecarta
