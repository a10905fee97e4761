// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/fast_slam_filters.hpp"

namespace montecarta {

FilterKind fastslam1_kind() {
  return {.name = "fastslam1",
          .long_name = "FastSLAM I",
          .source = "Montemerlo et al. 2002; SPEC 6",
          .has_particles = true,
          .has_mixture = false,
          .options = population_options(),
          .make = make_fastslam1<Lanes>};
}

}  // namespace montecarta
