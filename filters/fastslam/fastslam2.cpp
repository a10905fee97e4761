// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_filters.hpp"

namespace montecarta {

FilterKind fastslam2_kind() {
  std::vector<Option> options = population_options();
  options.push_back(choice_option("weights", "closed", weight_form_names(),
                                  "form of the importance weight (SPEC 7.2 c, r, b)"));
  return {.name = "fastslam2",
          .long_name = "FastSLAM II",
          .source = "Montemerlo et al. 2003; SPEC 7",
          .has_particles = true,
          .has_mixture = true,
          .options = std::move(options),
          .make = make_fastslam2<Lanes>};
}

}  // namespace montecarta
