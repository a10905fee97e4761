// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/srcd.hpp"

#include "filters/fastslam/moved.hpp"

namespace montecarta {

FilterKind srcd_kind() {
  std::vector<FilterOption> options = srcd_options();
  options.push_back(map_uncertainty_option());
  options.push_back(landmarks_option());
  options.push_back(move_lag_option());
  return {.name = "srcd",
          .long_name = "SRCD-FastSLAM",
          .source = "Ankishan et al. 2016; SPEC 10",
          .has_particles = true,
          .has_mixture = true,
          .options = std::move(options),
          .make =
              [](const FilterSetup& setup) {
                return make_as_chosen(setup, srcd_points(setup), make_srcd<Lanes>);
              },
          .check = check_move};
}

}  // namespace montecarta
