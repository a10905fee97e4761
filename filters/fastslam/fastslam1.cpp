// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/anchored.hpp"
#include "filters/fastslam/fast_slam_filters.hpp"

namespace montecarta {

FilterKind fastslam1_kind() {
  std::vector<FilterOption> options = fast_slam_options();
  options.push_back(landmarks_option());
  return {.name = "fastslam1",
          .long_name = "FastSLAM I",
          .source = "Montemerlo et al. 2002; SPEC 6",
          .has_particles = true,
          .has_mixture = false,
          .options = std::move(options),
          .make = [](const FilterSetup& setup) {
            return are_anchored(setup.options) ? make_fastslam1_anchored<Lanes>(setup)
                                               : make_fastslam1<Lanes>(setup);
          }};
}

}  // namespace montecarta
